import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.joint_reference import JointReference
from pack_core.robots.ur10e import LIMITS
from pack_sim.reference_follower import ReferenceFollower

STEP, WATCHDOG = 0.002, 0.1
REST = np.zeros(6)


def moving(time: float, speed: float, duration: float = 0.05) -> JointReference:
    offsets = np.array([0.0, duration])
    q = speed * np.outer(time + offsets, np.eye(6)[0])
    v = np.tile(speed * np.eye(6)[0], (2, 1))
    return JointReference(time, offsets, q, v, np.zeros((2, 6)))


@pytest.fixture
def follower() -> ReferenceFollower:
    return ReferenceFollower(LIMITS, WATCHDOG, deceleration=1.0)


def test_a_fresh_reference_is_followed(follower: ReferenceFollower) -> None:
    follower.accept(moving(0.0, 0.5), 0.0)
    q, v, _ = follower.at(0.02, REST)
    assert not follower.is_holding
    assert (q[0], v[0]) == pytest.approx((0.01, 0.5))


def test_an_arm_that_was_never_told_anything_stays_where_it_is(follower: ReferenceFollower) -> None:
    q, v, a = follower.at(1.0, np.arange(6.0))
    assert follower.is_holding
    assert q == pytest.approx(np.arange(6.0))
    assert not v.any()
    assert not a.any()


def test_without_fresh_references_the_arm_stops_within_the_acceleration_limits(
    follower: ReferenceFollower,
) -> None:
    speed = 1.0
    follower.accept(moving(0.0, speed), 0.0)
    times = np.arange(0.0, 1.0, STEP)
    rows = [follower.at(time, REST) for time in times]
    v, a = (np.array([row[i][0] for row in rows]) for i in (1, 2))
    assert follower.is_holding
    assert v[-1] == 0.0
    assert np.abs(a).max() <= LIMITS.acceleration[0] + 1e-9
    way = rows[-1][0][0] - 0.05 * speed
    assert way == pytest.approx(speed**2 / (2 * LIMITS.acceleration[0]), abs=2 * speed * STEP)


def test_a_reference_older_than_the_watchdog_is_not_followed(follower: ReferenceFollower) -> None:
    follower.accept(moving(0.0, 0.5, duration=10.0), 0.0)
    follower.at(WATCHDOG + STEP, REST)
    assert follower.is_holding


def test_a_dropped_reference_is_not_followed(follower: ReferenceFollower) -> None:
    follower.accept(moving(0.0, 0.5), 0.0)
    follower.drop()
    follower.at(STEP, REST)
    assert follower.is_holding


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"q": np.full((2, 6), 7.0)}, "position of shoulder_pan_joint is 7.000"),
        ({"v": np.full((2, 6), -9.0)}, "velocity of shoulder_pan_joint is -9.000"),
        ({"a": np.full((2, 6), 90.0)}, "acceleration of shoulder_pan_joint is 90.000"),
        ({"q": np.full((2, 6), np.nan)}, "position is not finite"),
        ({"v": np.zeros((2, 7))}, r"allowed: \(2, 6\)"),
        ({"offsets": np.array([0.0, 0.0])}, "rise"),
        ({"offsets": np.array([0.0, np.inf])}, "finite"),
    ],
)
def test_a_bad_reference_is_refused_and_named(
    follower: ReferenceFollower, change: dict[str, np.ndarray], named: str
) -> None:
    good = moving(0.0, 0.1)
    values = {name: getattr(good, name) for name in ("time", "offsets", "q", "v", "a")}
    with pytest.raises(MessageError, match=named):
        follower.accept(JointReference(**{**values, **change}), 0.0)
