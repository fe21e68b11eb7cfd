import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.robots.panda import PANDA
from pack_core.robots.ur10e import LIMITS
from pack_sim.brakes import (
    CATCH_UP,
    PERIOD,
    RAMP,
    SAME_POSITION,
    SAME_SPEED,
    SLOW_DOWN,
    GentleBrake,
    TorqueBrake,
)
from pack_sim.setpoint_follower import LEAD, ROUNDING, SAME_TIME, SLACK, SetpointFollower

STEP, WATCHDOG = 0.002, 0.1
REST, STANDING = np.zeros(6), np.zeros((2, 6))


def moving(time: float, speed: float, duration: float = 0.05) -> Setpoints:
    offsets = np.array([0.0, duration])
    q = speed * np.outer(time + offsets, np.eye(6)[0])
    v = np.tile(speed * np.eye(6)[0], (2, 1))
    return Setpoints(time, offsets, q, v, a=np.zeros((2, 6)))


@pytest.fixture
def follower() -> SetpointFollower:
    return SetpointFollower(LIMITS, WATCHDOG, GentleBrake(LIMITS, deceleration=1.0))


def test_a_fresh_reference_is_followed(follower: SetpointFollower) -> None:
    follower.accept(moving(0.0, 0.5), 0.0)
    q, v, _ = follower.at(0.02, REST, REST)
    assert not follower.is_holding
    assert (q[0], v[0]) == pytest.approx((0.01, 0.5))


def test_an_arm_that_was_never_told_anything_stays_where_it_is(follower: SetpointFollower) -> None:
    q, v, a = follower.at(1.0, np.arange(6.0), REST)
    assert follower.is_holding
    assert q == pytest.approx(np.arange(6.0))
    assert not v.any()
    assert not a.any()


def test_without_fresh_references_the_arm_stops_within_the_acceleration_limits(
    follower: SetpointFollower,
) -> None:
    speed = 1.0
    follower.accept(moving(0.0, speed), 0.0)
    times = np.arange(0.0, 1.0, STEP)
    rows = [follower.at(time, REST, REST) for time in times]
    v, a = (np.array([row[i][0] for row in rows]) for i in (1, 2))
    assert follower.is_holding
    assert v[-1] == 0.0
    assert np.abs(a).max() <= LIMITS.acceleration[0] + 1e-9
    way = rows[-1][0][0] - 0.05 * speed
    most = LIMITS.acceleration[0]
    assert way == pytest.approx(speed**2 / (2 * most) + 0.5 * speed * RAMP, abs=2 * speed * STEP)
    assert np.abs(np.diff(a)).max() <= 1.01 * most * STEP / RAMP


def test_a_reference_older_than_the_watchdog_is_not_followed(follower: SetpointFollower) -> None:
    follower.accept(moving(0.0, 0.5, duration=10.0), 0.0)
    follower.at(WATCHDOG + STEP, REST, REST)
    assert follower.is_holding


def test_the_last_row_of_a_reference_is_followed_at_a_time_that_rounding_makes_later(
    follower: SetpointFollower,
) -> None:
    assert 0.1 + 0.2 > 0.3
    follower.accept(moving(0.0, 0.5, duration=0.3), 0.25)
    follower.at(0.1 + 0.2, REST, REST)
    assert not follower.is_holding


def test_a_dropped_reference_is_not_followed(follower: SetpointFollower) -> None:
    follower.accept(moving(0.0, 0.5), 0.0)
    follower.drop()
    follower.at(STEP, REST, REST)
    assert follower.is_holding


def speed_at(follower: SetpointFollower, time: float) -> float:
    """Speed of the first joint that is wanted [rad/s]."""
    return round(float(follower.at(time, REST, REST)[1][0]), 9)


def test_setpoints_that_come_early_wait_for_the_time_of_their_first_row(follower: SetpointFollower) -> None:
    follower.accept(moving(0.0, 0.5, duration=0.3), 0.0)
    follower.accept(moving(0.05, 0.7, duration=0.3), 0.01)
    assert speed_at(follower, 0.02) == 0.5
    assert speed_at(follower, 0.05 - 2 * SAME_TIME) == 0.5
    assert speed_at(follower, 0.05 - 0.5 * SAME_TIME) == 0.7
    assert speed_at(follower, 0.06) == 0.7


@pytest.mark.parametrize("start", [0.02, 0.02 + 0.5 * SAME_TIME])
def test_setpoints_that_wait_are_given_up_for_ones_that_begin_now(
    follower: SetpointFollower, start: float
) -> None:
    follower.accept(moving(0.0, 0.5, duration=0.3), 0.0)
    follower.accept(moving(0.05, 0.7, duration=0.3), 0.01)
    follower.accept(moving(start, 0.6, duration=0.3), 0.02)
    assert speed_at(follower, 0.02) == 0.6
    assert speed_at(follower, 0.06) == 0.6


def test_setpoints_wait_no_longer_than_until_others_come(follower: SetpointFollower) -> None:
    follower.accept(moving(0.0, 0.5, duration=0.3), 0.0)
    follower.accept(moving(0.05, 0.7, duration=0.3), 0.01)
    follower.accept(moving(0.06, 0.6, duration=0.3), 0.02)
    assert speed_at(follower, 0.03) == 0.7
    assert speed_at(follower, 0.06) == 0.6


def test_a_stop_drops_setpoints_that_wait_too(follower: SetpointFollower) -> None:
    follower.accept(moving(0.05, 0.7, duration=0.3), 0.0)
    follower.drop()
    follower.at(0.06, REST, REST)
    assert follower.is_holding


def test_setpoints_are_held_against_the_watchdog_from_when_they_came(follower: SetpointFollower) -> None:
    follower.accept(moving(0.3, 0.5, duration=10.0), 0.25)
    follower.at(0.25 + 0.99 * WATCHDOG, REST, REST)
    assert not follower.is_holding
    follower.at(0.25 + 1.01 * WATCHDOG, REST, REST)
    assert follower.is_holding


def test_the_last_row_counts_no_longer_than_rounding_may_take(follower: SetpointFollower) -> None:
    follower.accept(moving(0.0, 0.5), 0.0)
    follower.at(0.05 + 0.5 * ROUNDING, REST, REST)
    assert not follower.is_holding
    follower.at(0.05 + 2 * ROUNDING, REST, REST)
    assert follower.is_holding


def test_setpoints_may_begin_as_much_ahead_as_the_lead_and_no_more(follower: SetpointFollower) -> None:
    def standing(start: float) -> Setpoints:
        return Setpoints(start, np.array([0.0, 0.05]), STANDING, STANDING, a=STANDING)

    follower.accept(standing(LEAD), 0.0)
    with pytest.raises(MessageError, match=f"ahead of the driver's time 0.000 s; allowed: {LEAD:.3f} s"):
        follower.accept(standing(LEAD + 1e-6), 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("joint", [0, 5])
@pytest.mark.parametrize("column", ["q", "v", "a"])
def test_a_limit_may_be_exceeded_by_rounding_alone(
    follower: SetpointFollower, column: str, joint: int, sign: float
) -> None:
    limits = {"q": LIMITS.upper, "v": LIMITS.velocity, "a": LIMITS.acceleration}[column]
    for share, is_allowed in ((0.9, True), (1.1, False)):
        rows = STANDING.copy()
        rows[1, joint] = sign * limits[joint] * (1.0 + share * SLACK)
        values = {"q": STANDING, "v": STANDING, "a": STANDING, column: rows}
        setpoints = Setpoints(0.0, np.array([0.0, 0.05]), **values)
        if is_allowed:
            follower.accept(setpoints, 0.0)
            continue
        text = f"of {LIMITS.names[joint]} is {rows[1, joint]:.3f} .*; allowed: {-limits[joint]:.3f} to"
        with pytest.raises(MessageError, match=text):
            follower.accept(setpoints, 0.0)


def starved(follower: SetpointFollower, gap: float) -> float:
    """An arm at 1 rad/s whose references end at 0.05 s: the time after a gap in them [s]."""
    follower.accept(moving(0.0, 1.0), 0.0)
    for time in np.arange(0.0, 0.05 + gap, STEP):
        follower.at(time, REST, REST)
    assert follower.is_holding
    return 0.05 + gap


def test_references_that_come_back_soon_are_joined_within_all_limits_and_then_followed(
    follower: SetpointFollower,
) -> None:
    start = starved(follower, 0.05)
    rows = [follower.at(start - STEP, REST, REST)]
    times = start + np.arange(0.0, 2.0, STEP)
    for time in times:
        follower.accept(moving(time, 1.0), time)
        rows.append(follower.at(time, REST, REST))
    q, v, a = (np.array([row[i][0] for row in rows]) for i in range(3))
    assert times[0] - q[1] > 1e-4
    assert q[-1] == pytest.approx(times[-1], abs=1e-12)
    assert np.abs(a).max() <= LIMITS.acceleration[0]
    np.testing.assert_allclose(np.diff(v), STEP * a[1:], atol=SAME_SPEED)
    np.testing.assert_allclose(np.diff(q), 0.5 * STEP * (v[:-1] + v[1:]), atol=2 * SAME_POSITION)
    assert v.max() <= 1.0 + CATCH_UP + SAME_SPEED


def test_references_that_come_back_far_from_where_the_arm_is_held_are_refused(
    follower: SetpointFollower,
) -> None:
    late = starved(follower, 1.0)
    with pytest.raises(MessageError, match=r"shoulder_pan_joint \+0\.\d+ rad from where the arm was held"):
        follower.accept(moving(late, 1.0), late)
    held, v, _ = follower.at(late, REST, REST)
    assert follower.is_holding
    assert not v.any()
    follower.accept(Setpoints(late, np.array([0.0, 0.05]), np.tile(held, (2, 1)), STANDING, a=STANDING), late)
    follower.at(late + STEP, REST, REST)
    assert not follower.is_holding


def test_references_that_begin_a_period_later_are_compared_with_where_the_braking_arm_is_then(
    follower: SetpointFollower,
) -> None:
    speed = 0.95 * LIMITS.velocity[0]
    follower.accept(moving(0.0, speed), 0.0)
    follower.at(0.05, REST, REST)
    q, v, _ = follower.at(0.05 + STEP, REST, REST)
    assert follower.is_holding
    step = PERIOD * v + 0.5 * PERIOD * LIMITS.velocity * np.eye(6)[0]
    rows = np.tile(q + step, (2, 1))
    later = Setpoints(0.05 + STEP + PERIOD, np.array([0.0, 0.05]), rows, STANDING, a=STANDING)
    follower.accept(later, 0.05 + STEP + PERIOD)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_held_arm_takes_what_its_velocity_limits_allow_in_a_period(
    follower: SetpointFollower, share: float
) -> None:
    follower.at(0.0, REST, REST)
    step = np.zeros((2, 6))
    step[:, 3] = -share * PERIOD * LIMITS.velocity[3]
    reference = Setpoints(0.0, np.array([0.0, 0.05]), step, STANDING, a=STANDING)
    if share < 1.0:
        follower.accept(reference, 0.0)
        return
    with pytest.raises(MessageError, match="wrist_1_joint"):
        follower.accept(reference, 0.0)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"q": np.full((2, 6), 7.0)}, "position of shoulder_pan_joint is 7.000"),
        ({"v": np.full((2, 6), -9.0)}, "velocity of shoulder_pan_joint is -9.000"),
        ({"a": np.full((2, 6), 90.0)}, "acceleration of shoulder_pan_joint is 90.000"),
        ({"q": np.full((2, 6), np.nan)}, "position is not finite"),
        ({"v": np.zeros((2, 7))}, r"allowed: \(2, 6\)"),
        ({"v": np.zeros((2, 5))}, r"has shape \(2, 5\); allowed: \(2, 6\)"),
        ({"q": np.zeros((1, 6))}, r"has shape \(1, 6\); allowed: \(2, 6\)"),
        ({"a": None, "tau": STANDING}, "setpoint a has shape None"),
        ({"offsets": np.array([0.05, 0.0])}, "rise"),
        ({"offsets": np.zeros(0)}, "number at least one"),
        ({"time": LEAD + 0.001}, "1.001 s ahead of the driver's time 0.000 s"),
        ({"offsets": np.array([0.0, 0.0])}, "rise"),
        ({"offsets": np.array([0.0, np.inf])}, "finite"),
    ],
)
def test_a_bad_reference_is_refused_and_named(
    follower: SetpointFollower, change: dict[str, np.ndarray], named: str
) -> None:
    good = moving(0.0, 0.1)
    values = {name: getattr(good, name) for name in ("time", "offsets", "q", "v", "a")}
    with pytest.raises(MessageError, match=named):
        follower.accept(Setpoints(**{**values, **change}), 0.0)


def led_by_torques() -> SetpointFollower:
    brake = TorqueBrake(PANDA.limits, lambda: np.eye(7), lambda: False)
    return SetpointFollower(PANDA.limits, WATCHDOG, brake)


def steady(speed: float, duration: float) -> Setpoints:
    """The first joint of a Panda turns at a speed, from its middle on."""
    offsets, first = 0.02 * np.arange(round(duration / 0.02) + 1), np.eye(7)[0]
    q = PANDA.limits.middle + speed * np.outer(offsets, first)
    v = np.tile(speed * first, (len(offsets), 1))
    return Setpoints(0.0, offsets, q, v, tau=np.ones_like(q))


def test_overdue_setpoints_slow_an_arm_that_is_led_by_torques_evenly_along_themselves() -> None:
    follower, speed = led_by_torques(), 0.4
    follower.accept(steady(speed, 0.24), 0.0)
    times = np.arange(0.0, WATCHDOG + SLOW_DOWN, STEP)
    rows = [follower.at(time, PANDA.limits.middle, np.zeros(7)) for time in times]
    q, v, tau = (np.array([row[i][0] for row in rows]) for i in range(3))
    assert not follower.is_holding
    expected = speed * np.clip(1.0 - (times - WATCHDOG) / SLOW_DOWN, 0.0, 1.0)
    assert v == pytest.approx(expected)
    assert np.diff(q) == pytest.approx(STEP * 0.5 * (v[1:] + v[:-1]), abs=1e-6), "the speed is that of q"
    assert (tau == 1.0).all()
    follower.at(WATCHDOG + SLOW_DOWN + STEP, PANDA.limits.middle, np.zeros(7))
    assert follower.is_holding


def test_setpoints_that_come_while_the_arm_slows_down_are_followed_at_once() -> None:
    follower = led_by_torques()
    follower.accept(steady(0.4, 0.24), 0.0)
    follower.at(WATCHDOG + 0.5 * SLOW_DOWN, PANDA.limits.middle, np.zeros(7))
    follower.accept(steady(0.4, 0.24), WATCHDOG + 0.5 * SLOW_DOWN)
    _, v, _ = follower.at(WATCHDOG + 0.5 * SLOW_DOWN, PANDA.limits.middle, np.zeros(7))
    assert v[0] == pytest.approx(0.4)


def test_dropped_setpoints_do_not_slow_the_arm_down_but_brake_it() -> None:
    follower = led_by_torques()
    follower.accept(steady(0.4, 0.24), 0.0)
    follower.drop()
    follower.at(STEP, PANDA.limits.middle, np.zeros(7))
    assert follower.is_holding
