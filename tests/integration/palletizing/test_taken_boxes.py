"""Boxes that somebody takes or turns while an order is built: the cell notices, and goes on or stops."""

from collections.abc import Callable

import numpy as np
import pytest

from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.rotations import Pose, angle_between, from_yaw, multiply
from pack_lockstep.palletizing.benchmark import plan_order
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import set_up
from pack_sim.palletizing.simulator import PalletSimulator
from pallet_fsm.report import BoxOutcome, BoxReport
from pallet_fsm.states import State

INTO = 0.05
"""Time in a state after which the hand reaches in [s]."""
Hand = Callable[[PalletSimulator, str], None]


def turn(simulator: PalletSimulator, name: str) -> None:
    """Turn a box that stands on a table by 20 degrees."""
    X_WB = simulator.truth().objects[name].X_WO
    body = next(box for box in simulator.boxes if box.name == name)
    simulator.remove(name)
    simulator.spawn(body, Pose(X_WB.p, multiply(from_yaw(np.deg2rad(20.0)), X_WB.q)))


def run_with(hand: Hand, state: State, until: State | None = None) -> tuple[PalletLockstep, str]:
    """Order 14, and what somebody does to its first box in a state; and why the order ended.

    A state `until` that is entered after the hand ends the order.
    """
    setup = set_up(vision=False)
    order = load_order(config_path("orders", "order_14.json"))
    cell = PalletLockstep(setup.cell, order, plan_order(order, setup.layout), setup.config, seed=0)
    first, done = order.boxes[0].id, list[float]()

    def watch(tick: Tick) -> None:
        visit = cell.palletizer.machine.visits[-1]
        if not done and (visit.box, visit.state) == (first, state) and tick.time > visit.time + INTO:
            done.append(tick.time)
            hand(cell.simulator, first)
        if done and visit.state is until:
            cell.palletizer.halt(f"in state {until.label}")

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
def test_a_box_that_is_turned_on_the_way_to_it_is_looked_at_again_and_gripped_as_it_lies() -> None:
    cell, _ = run_with(turn, State.ABOVE_BOX, until=State.LIFT)
    (changed,) = cell.palletizer.report().faults
    assert changed.state is State.BOX_CHANGED
    assert "20.0 degrees from where it was" in changed.reason
    item = cell.palletizer.item
    assert item.X_TB is not None
    true = cell.simulator.tool_pose().inverse() @ cell.simulator.truth().objects[item.name].X_WO
    assert np.linalg.norm(true.p - item.X_TB.p) < 0.002
    assert np.degrees(angle_between(true.q, item.X_TB.q)) < 0.5


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
