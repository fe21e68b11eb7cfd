"""The contact governor: bounds in contact, nothing in free motion."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pydantic import ValidationError

from pack_core.kinematics.damping import DAMPING
from pack_sim.packing.contact_governor import ContactGovernor, ContactGovernorConfig

CONFIG = ContactGovernorConfig()
STEP = 0.001
J = np.hstack([np.eye(6), np.zeros((6, 1))])
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture
def governor() -> ContactGovernor:
    return ContactGovernor(CONFIG, STEP)


def press(
    governor: ContactGovernor, force: np.ndarray, start: float = 0.0, steps: int = 100, bending: float = 0.0
) -> bool:
    """Feel a constant load for some steps of the driver."""
    return [governor.update(start + STEP * i, force, bending, is_holding=False) for i in range(steps)][-1]


def wrench_of(tau: np.ndarray) -> np.ndarray:
    return np.linalg.solve(J @ J.T + DAMPING * np.eye(6), J @ tau)


def test_contact_is_remembered_for_the_latch_and_then_forgotten(governor: ContactGovernor) -> None:
    assert press(governor, 10.0 * UP)
    assert press(governor, 0.0 * UP, start=0.1)
    assert not press(governor, 0.0 * UP, start=0.2, steps=200)


def test_a_bias_shown_while_the_arm_is_held_is_no_contact(governor: ContactGovernor) -> None:
    for i in range(300):
        governor.update(STEP * i, 2.5 * UP, 0.0, is_holding=True)
    assert not press(governor, 2.5 * UP, start=0.3, steps=300)
    assert not press(governor, 6.0 * UP, start=0.6)
    assert press(governor, 8.0 * UP, start=0.7)


def test_a_bias_that_drifts_in_free_motion_is_followed(governor: ContactGovernor) -> None:
    contacts = [governor.update(STEP * i, 1.25e-4 * i * UP, 0.0, is_holding=False) for i in range(20_000)]
    assert not any(contacts)
    assert not press(governor, 6.0 * UP, start=20.0)


def test_a_contact_that_grows_slowly_does_not_pass_for_a_bias(governor: ContactGovernor) -> None:
    contacts = [governor.update(STEP * i, 0.001 * i * UP, 0.0, is_holding=False) for i in range(20_000)]
    assert contacts[-1]
    assert contacts.index(True) < 1.1 * (CONFIG.bias + CONFIG.trigger) / 0.001


def test_what_still_pushes_after_a_long_way_back_is_a_bias(governor: ContactGovernor) -> None:
    assert press(governor, 6.0 * UP)
    for _ in range(round(CONFIG.draw_back / (0.1 * STEP)) + 2):
        governor.follow(0.1 * UP)
    assert not press(governor, 6.0 * UP, start=0.1)


def test_contact_stays_contact_while_it_is_pushed_ahead(governor: ContactGovernor) -> None:
    assert press(governor, 6.0 * UP)
    for _ in range(1000):
        governor.follow(-0.1 * UP)
    assert press(governor, 6.0 * UP, start=0.1)


def test_torques_within_the_bounds_pass_as_they_are(governor: ContactGovernor) -> None:
    press(governor, 5.0 * UP)
    tau = J.T @ np.array([10.0, 0.0, -10.0, 0.5, 0.0, 0.0])
    np.testing.assert_allclose(governor.bound(tau, J), tau)


@example([0.0, 0.0, -19.0, 0.0, 0.0, 0.0, 0.0], 5.0)
@given(st.lists(st.floats(-80.0, 80.0), min_size=7, max_size=7), st.floats(5.0, 60.0))
def test_what_presses_is_within_the_bounds(tau: list[float], force: float) -> None:
    governor = ContactGovernor(CONFIG, STEP)
    press(governor, force * UP)
    wrench = wrench_of(governor.bound(np.array(tau), J))
    assert np.hypot(wrench[0], wrench[1]) <= CONFIG.force + 1e-6
    assert -wrench[2] <= min(CONFIG.force, CONFIG.push) + 1e-6


@pytest.mark.parametrize(
    ("bending", "share"),
    [
        (CONFIG.bending, 1.0),
        (0.5 * (CONFIG.bending + CONFIG.bending_limit), 0.5),
        (CONFIG.bending_limit, 0.0),
    ],
)
def test_the_arm_gives_way_where_the_load_bends_the_cup(
    governor: ContactGovernor, bending: float, share: float
) -> None:
    press(governor, 5.0 * UP, bending=bending)
    tau = J.T @ np.array([10.0, 0.0, -10.0, 5.0, 0.0, 0.0])
    np.testing.assert_allclose(governor.bound(tau, J), share * tau, atol=1e-6)


def test_beyond_the_limit_of_bending_it_pulls_back_in_proportion(governor: ContactGovernor) -> None:
    """As much beyond the limit as giving way takes to get there: it pulls as hard as it may push."""
    press(governor, 5.0 * UP, bending=2.0 * CONFIG.bending_limit - CONFIG.bending)
    wrench = wrench_of(governor.bound(J.T @ np.array([0, 0, -15.0, 0, 0, 0]), J))
    assert wrench[2] == pytest.approx(CONFIG.push, rel=0.01)


def test_however_far_the_cup_is_bent_it_pulls_back_with_no_more_than_its_limit(
    governor: ContactGovernor,
) -> None:
    press(governor, 5.0 * UP, bending=5.0 * CONFIG.bending_limit)
    wrench = wrench_of(governor.bound(J.T @ np.array([10.0, 0.0, -10.0, 5.0, 0.0, 0.0]), J))
    np.testing.assert_allclose(wrench, [0.0, 0.0, CONFIG.pull_back, 0.0, 0.0, 0.0], atol=0.01)


def test_giving_way_must_begin_before_its_limit() -> None:
    with pytest.raises(ValidationError, match="less than bending_limit"):
        ContactGovernorConfig(bending=1.5, bending_limit=1.1)


def test_beyond_the_push_limit_it_pulls_back_in_proportion(governor: ContactGovernor) -> None:
    press(governor, (CONFIG.push + 10.0) * UP, steps=200)
    wrench = wrench_of(governor.bound(J.T @ np.array([0, 0, -15.0, 0, 0, 0]), J))
    assert wrench[2] == pytest.approx(CONFIG.reflex * 10.0 - CONFIG.push, rel=0.01)


def test_only_the_velocity_into_the_contact_is_capped(governor: ContactGovernor) -> None:
    press(governor, 10.0 * UP)
    v = np.array([0.2, 0.1, -0.3, 0.0, 0.0, 0.0, 0.5])
    slowed = governor.slow_down(v, J)
    np.testing.assert_allclose(slowed[[0, 1, 3, 4, 5, 6]], v[[0, 1, 3, 4, 5, 6]], atol=1e-9)
    assert slowed[2] == pytest.approx(-CONFIG.approach, abs=1e-4)
    np.testing.assert_array_equal(governor.slow_down(-v, J), -v)


def rest(governor: ContactGovernor, seconds: float, speed: float = 0.0) -> None:
    """Follow the cup, which moves with this speed into a contact from below, for some time."""
    for _ in range(round(seconds / STEP)):
        governor.follow(-speed * UP)


def test_on_what_goes_on_bearing_the_object_the_speed_down_grows(governor: ContactGovernor) -> None:
    press(governor, 10.0 * UP)
    v = np.array([0.2, 0.0, -0.3, 0.0, 0.0, 0.0, 0.5])
    rest(governor, 0.5)
    assert governor.slow_down(v, J)[2] == pytest.approx(-CONFIG.approach - 0.5 * CONFIG.build_up, abs=1e-4)
    rest(governor, 5.0)
    np.testing.assert_allclose(governor.slow_down(v, J), v)


def test_what_gives_way_is_met_slowly_again(governor: ContactGovernor) -> None:
    press(governor, 10.0 * UP)
    rest(governor, 5.0)
    rest(governor, STEP, speed=0.02)
    slowed = governor.slow_down(np.array([0.0, 0.0, -0.3, 0.0, 0.0, 0.0, 0.0]), J)
    assert slowed[2] == pytest.approx(-CONFIG.approach, abs=1e-4)


def test_sideways_the_speed_into_a_contact_does_not_grow(governor: ContactGovernor) -> None:
    side = np.array([1.0, 0.0, 0.0])
    press(governor, 10.0 * side)
    rest(governor, 5.0)
    slowed = governor.slow_down(np.array([-0.3, 0.0, -0.3, 0.0, 0.0, 0.0, 0.0]), J)
    np.testing.assert_allclose(slowed[[0, 2]], [-CONFIG.approach, -0.3], atol=1e-4)


def test_what_is_held_down_is_drawn_out_harder_than_is_pressed(governor: ContactGovernor) -> None:
    press(governor, -28.0 * UP, steps=200)
    up = J.T @ np.array([0.0, 0.0, CONFIG.pull_out + 10.0, 0.0, 0.0, 0.0])
    assert wrench_of(governor.bound(up, J))[2] == pytest.approx(CONFIG.pull_out, rel=0.01)
    v = np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(governor.slow_down(v, J), v)


@pytest.mark.parametrize("side", [np.array([1.0, 0.0, 0.0]), np.array([0.8, 0.0, -0.6])])
def test_what_is_pushed_from_the_side_is_not_drawn_out(governor: ContactGovernor, side: np.ndarray) -> None:
    press(governor, 15.0 * side, steps=200)
    against = J.T @ np.array([*(-40.0 * side), 0.0, 0.0, 0.0])
    assert -side @ wrench_of(governor.bound(against, J))[:3] <= CONFIG.push + 1e-6


@given(st.floats(-60.0, 60.0))
def test_a_driver_without_a_trigger_feels_no_contact(force: float) -> None:
    governor = ContactGovernor(ContactGovernorConfig(trigger=math.inf), STEP)
    assert not press(governor, force * UP, bending=9.0)
