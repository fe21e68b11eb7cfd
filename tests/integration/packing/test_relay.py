"""Packing through the relay and a joint trajectory controller, which is no driver of the cell's own."""

from __future__ import annotations

import pytest

from foreign_driver.effort_arm import relay_driven
from integration.packing.cell_rig import EASY
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingExitReason, PackingMethod
from pack_core.packing.scene_file import load_scene
from pack_lockstep.packing.lockstep import Lockstep
from pack_lockstep.packing.lockstep_config import lockstep_config


def test_a_scene_is_packed_and_the_arm_is_held_when_plans_end() -> None:
    lockstep = Lockstep(packing_cell(), load_scene(EASY), lockstep_config(), PackingMethod.PACK_IT_IN, 0)
    simulator = lockstep.simulator
    arm = relay_driven(simulator)
    outcome = lockstep.run()
    assert outcome.exit_reason is PackingExitReason.PLACED
    assert not arm.trouble
    assert arm.sent > 10
    simulator.release()
    for _ in range(400):
        simulator.step()
    held = simulator.joints()
    for _ in range(200):
        simulator.step()
    assert simulator.joints().q == pytest.approx(held.q, abs=1e-3)
