"""Packing through the relay and a joint trajectory controller, which is no driver of the cell's own."""

from __future__ import annotations

import pytest

from foreign_driver.driver_nodes import PackingDriverNode
from foreign_driver.effort_arm import relay_driven
from integration.harness import Graph
from integration.packing.cell_rig import EASY, Cell
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingExitReason, PackingMethod
from pack_core.packing.scene_file import load_scene
from pack_lockstep.packing.lockstep import Lockstep
from pack_lockstep.packing.lockstep_config import lockstep_config
from pack_sim.packing.effort_relay_node import EffortRelayNode

FACTOR = 0.3
"""Real-time factor at which one process runs six nodes."""


def test_a_goal_is_packed_by_nodes_whose_driver_takes_trajectories(graph: Graph) -> None:
    relay = graph.start(EffortRelayNode)
    cell = Cell(graph, FACTOR, sim=PackingDriverNode)
    graph.wait_until(lambda: not relay.waits_for)
    result = graph.result_of(cell.pack())
    assert result.exit_reason == "placed", result.message
    ended = cell.time
    cell.wait_past(ended + 0.3)
    assert cell.time_to_rest(ended) < 0.2
    assert not relay.health.counts
    assert not cell.sim.shell.rejections


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
