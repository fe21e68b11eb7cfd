"""What each driver of an arm must do that is led along positions (docs/operate/driver.md).

They run against the simulators of the palletizing and the blocks cell, which take setpoints, and against the
tests' own joint trajectory controller with either arm; `pack driver check CELL` names another driver.
With a real arm they MOVE IT: the last joint, by some degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from contract.position_rig import PositionRig
from pack_core.joints import Setpoints
from pack_core.motion import topics
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import to_trajectory

TURN, DURATION = 0.1, 1.0
"""Of the last joint [rad, s]: at most 0.19 rad/s."""
ARRIVED = 2e-3
"""How near to the end of a move a joint is [rad]."""
STILL = 2e-3
"""By which a joint that is not to move may be off [rad]."""
MOVING = 0.08
"""Speed at which a joint counts as on its way [rad/s]."""
STOP = 0.6
"""Within which an arm must rest that is led no longer, or is stopped [s]."""
WATCHED = 0.3
"""For which an arm that is not to move is watched [s]."""


def turned(rig: PositionRig, start: np.ndarray) -> float:
    """How far the last joint has turned since, inwards [rad]."""
    return rig.inwards * float(rig.joints.q[-1] - start[-1])


def assert_stands(rig: PositionRig) -> None:
    """The arm rests, and stays for a while."""
    begun, held = rig.time, rig.joints.q
    rig.wait(WATCHED)
    away = max(np.abs(sample.q - held).max() for sample in rig.samples(begun))
    assert away < STILL, f"the arm moved by {away:.4f} rad; allowed: {STILL}"


def set_going(rig: PositionRig) -> Callable[[], object]:
    """Begin a move and lead the arm until it is on its way."""
    go_on = rig.begin(TURN, DURATION)
    rig.follow(go_on, lambda: np.abs(rig.joints.v[-1]) > MOVING)
    return go_on


def test_it_tells_joints_at_the_cells_rate_by_the_clock(position_rig: PositionRig) -> None:
    rig = position_rig
    begun, mail = rig.time, rig.graph.probe.mail[shared.CLOCK.name]
    rig.wait(WATCHED)
    rig.graph.wait_until(lambda: mail)
    samples, limits = rig.samples(begun), rig.arm.limits
    gaps = np.diff([sample.time for sample in samples])
    assert np.all(gaps > 0.0)
    assert np.median(gaps) == pytest.approx(1.0 / topics.JOINT_RATE, rel=0.2)
    assert abs(from_stamp(mail[-1].clock) - rig.time) < 0.1
    for sample in samples:
        assert np.all(np.isfinite([sample.q, sample.v, sample.tau]))
        assert np.all((limits.lower <= sample.q) & (sample.q <= limits.upper))


def test_it_goes_where_it_is_led_and_moves_no_other_joint(position_rig: PositionRig) -> None:
    rig = position_rig
    start = rig.joints.q
    go_on = rig.begin(TURN, DURATION)
    begun = rig.time
    rig.follow(go_on, lambda: rig.time > begun + DURATION + 0.2)
    assert turned(rig, start) == pytest.approx(TURN, abs=ARRIVED)
    others = max(np.abs(np.delete(sample.q - start, -1)).max() for sample in rig.samples(begun))
    assert others < STILL
    assert not rig.aborted
    assert_stands(rig)


def test_it_rests_and_holds_when_it_is_led_no_longer(position_rig: PositionRig) -> None:
    rig = position_rig
    start = rig.joints.q
    set_going(rig)
    rig.halt()
    rig.wait(STOP)
    assert 0.0 < turned(rig, start) < TURN - STILL
    assert_stands(rig)


def test_a_trajectory_replaces_the_one_before_in_motion(position_rig: PositionRig) -> None:
    rig = position_rig
    if not rig.takes_trajectories:
        pytest.skip("of drivers that take trajectories")
    start, way = rig.joints.q, rig.turn(TURN, DURATION)
    rig.send_trajectory(on_way(way, rig.time, DURATION))
    rig.wait_until(lambda: np.abs(rig.joints.v[-1]) > MOVING)
    # The same way, from where the arm is on it: the first row has passed when it comes.
    begun = rig.time
    rig.send_trajectory(on_way(way, begun, DURATION))
    rig.wait(DURATION + 0.3)
    assert turned(rig, start) == pytest.approx(TURN, abs=ARRIVED)
    v = np.array([sample.v[-1] for sample in rig.samples(begun)])
    assert np.abs(np.diff(v)).max() < 0.05, "the speed jumped where one trajectory replaced the other"
    assert not rig.aborted


def on_way(way: Callable[[float], tuple[np.ndarray, ...]], begun: float, duration: float) -> Setpoints:
    """The way in rows, from `begun` to after its end."""
    offsets = np.arange(0.0, duration + 0.02, 0.02)
    q, v, a = (np.array(column) for column in zip(*(way(begun + o) for o in offsets), strict=True))
    return Setpoints(begun, offsets, q, v, a=a)


def test_a_stopped_arm_stands_takes_nothing_and_moves_only_when_it_is_led_anew(
    position_rig: PositionRig,
) -> None:
    rig = position_rig
    go_on = set_going(rig)
    stops = rig.arm_state.stops
    rig.stop()
    rig.graph.wait_until(lambda: rig.arm_state.is_stopped and rig.arm_state.is_standing)
    assert rig.arm_state.stops == stops + 1
    rested = rig.joints.q
    begun = rig.time
    rig.follow(go_on, lambda: rig.time > begun + WATCHED)  # whoever leads it does not know yet
    assert np.abs(rig.joints.q - rested).max() < STILL
    rig.resume()
    rig.graph.wait_until(lambda: not rig.arm_state.is_stopped)
    assert_stands(rig)
    again = rig.joints.q
    go_on, begun = rig.begin(-TURN, DURATION), rig.time
    rig.follow(go_on, lambda: rig.time > begun + DURATION + 0.2)
    assert turned(rig, again) == pytest.approx(-TURN, abs=ARRIVED)


def without_rows(setpoints: Setpoints) -> Setpoints:
    return Setpoints(
        setpoints.time, setpoints.offsets[:0], setpoints.q[:0], setpoints.v[:0], a=setpoints.a[:0]
    )


def ended(setpoints: Setpoints) -> Setpoints:
    """Its first row alone, whose time has passed."""
    zero = np.zeros_like(setpoints.q[:1])
    return Setpoints(max(setpoints.time - 10.0, 1e-3), np.zeros(1), setpoints.q[:1], zero, a=zero)


def spoilt(column: str, value: float) -> Callable[[Setpoints], Setpoints]:
    def spoil(setpoints: Setpoints) -> Setpoints:
        values = getattr(setpoints, column).copy()
        values[-1, -1] = value
        return replace(setpoints, **{column: values})

    return spoil


OF_ALL = {"without rows": without_rows}
OF_SETPOINTS = {
    "a position that is no number": spoilt("q", math.nan),
    "a speed beyond the limit": spoilt("v", 500.0),
    "a position beyond the range": spoilt("q", 500.0),
}
OF_TRAJECTORIES = {"that have ended": ended, "that end in motion": spoilt("v", 0.3)}


def test_what_cannot_be_followed_is_refused_and_moves_nothing(position_rig: PositionRig) -> None:
    rig = position_rig
    refused, way = rig.refusals(), rig.turn(TURN, DURATION)
    kinds = OF_ALL | (OF_TRAJECTORIES if rig.takes_trajectories else OF_SETPOINTS)
    for what, spoil in kinds.items():
        begun, held = rig.time, rig.joints.q
        if rig.takes_trajectories:
            rig.send_trajectory(spoil(on_way(way, begun, DURATION)))
        else:
            rig.send(to_trajectory(spoil(rig.setpoints(way)), rig.arm.limits.names))
        refused += 1
        rig.graph.wait_until(lambda refused=refused: rig.refusals() >= refused)
        away = max(np.abs(sample.q - held).max() for sample in rig.samples(begun - 0.01))
        assert away < STILL, f"{what}: moved by {away:.4f} rad; allowed: {STILL}"
    go_on, begun = rig.begin(TURN / 2, DURATION), rig.time
    rig.follow(go_on, lambda: rig.time > begun + DURATION + 0.2)
    assert turned(rig, held) == pytest.approx(TURN / 2, abs=ARRIVED)
