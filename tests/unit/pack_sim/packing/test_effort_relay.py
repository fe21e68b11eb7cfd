"""What the relay passes on to a joint trajectory controller, and when it has the arm held."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.joints import JointSample, Setpoints, hold
from pack_core.robots.panda import PANDA
from pack_sim.packing.effort_relay import AT_ONCE, EffortRelay

WATCHDOG = 0.1
MIDDLE = 0.5 * (PANDA.limits.lower + PANDA.limits.upper)
STILL = np.zeros(7)


def sample(time: float, q: np.ndarray = MIDDLE) -> JointSample:
    return JointSample(time, q, STILL, STILL)


def plan(time: float) -> Setpoints:
    return Setpoints(time, np.array([0.0, 0.24]), np.tile(MIDDLE, (2, 1)), np.zeros((2, 7)), np.ones((2, 7)))


@pytest.fixture
def relay() -> EffortRelay:
    made = EffortRelay(PANDA.limits, WATCHDOG)
    assert made.advance(sample(1.0)) is None, "nothing was passed on yet, so nothing is held"
    return made


def test_a_plan_is_passed_on_as_it_is(relay: EffortRelay) -> None:
    setpoints = plan(1.01)
    assert relay.accept(setpoints, 1.01) is setpoints
    assert relay.advance(sample(1.05)) is None


def test_a_hold_becomes_one_row_where_the_arm_is_measured_to_be_begun_at_once(relay: EffortRelay) -> None:
    relay.accept(plan(1.0), 1.0)
    relay.advance(sample(1.002))
    assert relay.accept(hold(sample(1.0)), 1.01) is None, "the controller would refuse what is over"
    further = MIDDLE + 0.01
    held = relay.advance(sample(1.012, further))
    assert held is not None
    assert (held.time, held.offsets.tolist()) == (AT_ONCE, [0.0])
    np.testing.assert_array_equal(held.q, further[None])
    assert not held.v.any()
    assert not held.fed_forward.any()
    assert relay.advance(sample(1.014, further)) is None, "it is said once"


def test_the_arm_is_held_when_no_plan_has_come_for_the_watchdog_s_time(relay: EffortRelay) -> None:
    relay.accept(plan(1.0), 1.0)
    times = 1.0 + 0.002 * np.arange(1, 100)
    held_at = [time for time in times.tolist() if relay.advance(sample(time)) is not None]
    assert held_at == [pytest.approx(1.0 + WATCHDOG + 0.002, abs=3e-3)]


def test_it_goes_on_after_a_hold_and_holds_again_when_the_sender_dies(relay: EffortRelay) -> None:
    for begun in (1.0, 2.0):
        relay.accept(plan(begun), begun)
        assert relay.advance(sample(begun + 0.01)) is None
        relay.drop()
        assert relay.advance(sample(begun + 0.012)) is not None


def test_what_no_arm_can_follow_is_refused_and_the_plan_before_goes_on(relay: EffortRelay) -> None:
    relay.accept(plan(1.0), 1.0)
    bad = plan(1.01)
    bad.tau[0, 3] = 500.0
    with pytest.raises(MessageError, match="torque of"):
        relay.accept(bad, 1.01)
    assert relay.advance(sample(1.02)) is None
