"""The palletizing arm is stopped in each group of the machine's states, in lockstep."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from integration.stoppable_arm import StoppableArm, assert_a_stop_is_safe
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.robots.kr210 import LIMITS
from pack_lockstep.palletizing.benchmark import plan_order
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import set_up
from pallet_fsm.states import State

WHO = "the test's emergency stop"
MOVING = 0.05
"""Speed of a joint from which on the arm moves [rad/s]."""
PLAIN = config_path("orders", "order_03.json")
OVER_TABLE_B = config_path("scenarios", "palletizing", "by_hand.json")
"""Its first box is stood up on table B."""
GROUPS = [
    (PLAIN, State.ABOVE_BOX, False), (PLAIN, State.GRASP, None), (PLAIN, State.ABOVE_PALLET, True),
    (PLAIN, State.PRE_DEPOSIT, True), (PLAIN, State.DEPOSIT, None), (PLAIN, State.RETREAT, False),
    (OVER_TABLE_B, State.ROTATE, True), (OVER_TABLE_B, State.REGRASP, None),
    (OVER_TABLE_B, State.LIFT_TABLE, True),
]  # fmt: skip
"""Order, state, and whether a box is held in it; None: the gripper is at work, and the arm may stand."""


def lockstep(path: Path) -> PalletLockstep:
    setup, order = set_up(vision=False), load_order(path)
    return PalletLockstep(setup.cell, order, plan_order(order, setup.layout), setup.config, seed=0)


@pytest.mark.parametrize(
    ("order", "state", "is_held"), GROUPS, ids=[state.name.lower() for _, state, _ in GROUPS]
)
def test_a_stopped_arm_stands_keeps_its_box_and_begins_anew_where_it_is(
    order: Path, state: State, is_held: bool | None
) -> None:
    cell = lockstep(order)
    stepped, gripper = cell.stepped, cell.simulator.gripper
    arm = stepped.arm = StoppableArm(stepped.motion, stepped.simulator, LIMITS)
    held: list[str] = []

    def stop(tick: Tick) -> None:
        assert arm.sample is not None or tick.state is not state
        if tick.state is state and not held and (is_held is None or np.abs(arm.sample.v).max() > MOVING):
            held.append(gripper.state.held)
            arm.stop(WHO)
            cell.palletizer.halt(f"the arm was stopped: {WHO}")

    run = cell.run(stop)
    assert held, "the machine never was in this state"
    assert run.reason == f"the arm was stopped: {WHO}"
    assert run.visits[-1].state == State.SAFE_STOP.label
    assert_a_stop_is_safe(arm, stepped.motion)
    if is_held is not None:
        assert bool(held[0]) == is_held
        assert gripper.state.held == held[0]
