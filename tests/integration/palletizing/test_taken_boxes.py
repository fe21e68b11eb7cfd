"""Boxes that somebody takes out of the cell while an order is built: the cell says so and stands safely."""

from collections.abc import Callable

import numpy as np
import pytest

from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_lockstep.palletizing.benchmark import plan_order
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import set_up
from pack_sim.palletizing.simulator import PalletSimulator
from pallet_fsm.report import BoxOutcome, BoxReport
from pallet_fsm.states import State

INTO = 0.05
"""Time in a state after which the hand reaches in [s]."""
Hand = Callable[[PalletSimulator, str], None]


def run_with(hand: Hand, state: State) -> tuple[PalletLockstep, str]:
    """Order 14, and what somebody does to its first box in a state; and why the order ended."""
    setup = set_up(profile="blended", motion="shipped", preset="rigid", vision=False)
    order = load_order(config_path("orders", "order_14.json"))
    cell = PalletLockstep(setup.cell, order, plan_order(order, setup.layout), setup.config, seed=0)
    first, done = order.boxes[0].id, list[float]()

    def watch(tick: Tick) -> None:
        visit = cell.palletizer.machine.visits[-1]
        if not done and (visit.box, visit.state) == (first, state) and tick.time > visit.time + INTO:
            done.append(tick.time)
            hand(cell.simulator, first)

    reason = cell.run(watch).reason
    assert done, f"state {state} was not reached"
    return cell, reason


def outcome(cell: PalletLockstep) -> BoxReport:
    """Of the first box."""
    return cell.palletizer.report().boxes[0]


@pytest.mark.timeout(300)
def test_a_box_that_is_taken_before_it_is_gripped_is_skipped_with_what_would_stand_on_it() -> None:
    cell, reason = run_with(PalletSimulator.remove, State.ABOVE_BOX)
    taken, upper = cell.palletizer.report().boxes
    assert taken.outcome is BoxOutcome.SKIPPED, reason
    assert taken.reason
    assert upper.outcome is BoxOutcome.SKIPPED
    assert f"{taken.name}, which was skipped" in upper.reason


@pytest.mark.timeout(300)
@pytest.mark.parametrize("state", [State.LIFT, State.PRE_DEPOSIT])
def test_a_box_that_is_taken_out_of_the_gripper_stops_the_arm_and_is_named(state: State) -> None:
    cell, reason = run_with(PalletSimulator.remove, state)
    first = outcome(cell)
    assert first.outcome is BoxOutcome.LOST
    assert f"box '{first.name}' was taken away" in reason
    before = cell.simulator.tool_pose()
    cell.simulator.step()
    assert np.linalg.norm(cell.simulator.tool_pose().p - before.p) < 1e-4
