import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core import rotations
from pack_core.rotations import IDENTITY
from pack_evaluation.track import Track


def moving(count: int) -> Track:
    """From the origin along x with 1 m/s, turning about z with 1 rad/s."""
    times = np.linspace(0.0, 1.0, count)
    p = np.stack([times, np.zeros(count), np.zeros(count)], axis=-1)
    q = np.stack([rotations.from_yaw(time) for time in times])
    return Track(times, p, q, np.zeros(count, dtype=np.uint8))


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20).map(sorted))
def test_positions_between_samples_lie_on_the_line(times: list[float]) -> None:
    assert moving(11).at(np.array(times)).p[:, 0] == pytest.approx(times)


@given(st.floats(0.0, 1.0))
def test_an_orientation_between_samples_is_that_of_the_nearest(time: float) -> None:
    yaw = rotations.yaw_of(moving(11).at(np.array([time])).q[0])
    assert abs(yaw - time) <= 0.05 + 1e-9


def test_a_window_holds_its_bounds() -> None:
    assert moving(11).between(0.2, 0.5).times == pytest.approx([0.2, 0.3, 0.4, 0.5])


def test_displacement_is_the_distance_from_the_first_sample() -> None:
    assert moving(11).between(0.5, 1.0).displacement()[-1] == pytest.approx(0.5)


def test_the_angle_between_two_tracks_is_that_of_their_rotations() -> None:
    still = Track(np.array([0.3]), np.zeros((1, 3)), IDENTITY[None], np.zeros(1, dtype=np.uint8))
    assert moving(11).at(np.array([0.3])).angle_to(still) == pytest.approx([0.3])
