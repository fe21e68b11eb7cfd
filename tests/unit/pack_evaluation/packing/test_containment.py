"""Where the held object ends, on poses whose containment is known in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core import rotations
from pack_core.rotations import Array, Pose
from pack_evaluation.packing.measures import TOLERANCE, Containment, containment
from unit.pack_evaluation.packing.runs import TARGET, make_run

RUN = make_run()
CONTAINER, ITEM = RUN.scene.container, RUN.scene.new_object
HALF = ITEM.half_extents
ROOM = 0.5 * np.array(CONTAINER.size) - HALF[:2]
"""How far the upright object may be from the middle of the container, along x and y [m]."""


def end_at(p: Array, q: Array = rotations.IDENTITY) -> Containment:
    track = RUN.truth[RUN.held]
    rows = np.ones((track.times.size, 1))
    return containment(replace(RUN, truth={**RUN.truth, RUN.held: replace(track, p=rows * p, q=rows * q)}))


def test_in_the_middle_it_is_contained_and_looks_out_at_the_top() -> None:
    end = end_at(TARGET)
    assert end.is_contained
    assert end.protrusion == 0.0
    assert end.top_over_rim == pytest.approx(2 * HALF[2] - CONTAINER.height)
    assert end.centre_over_rim == pytest.approx(HALF[2] - CONTAINER.height)
    assert end.tilt == 0.0


@given(
    beyond=st.floats(0.0, 0.2), side=st.sampled_from([(1, 0), (-1, 0), (0, 1), (0, -1)]),
    along=st.floats(-1.0, 1.0),
)  # fmt: skip
def test_protrusion_is_how_far_it_is_shifted_through_a_wall(
    beyond: float, side: tuple[int, int], along: float
) -> None:
    n = np.array(side, dtype=float)
    across = np.abs(n[::-1]) * ROOM * along  # anywhere along the wall
    end = end_at(TARGET + np.append(n * (ROOM + beyond) + across, 0.0))
    assert end.protrusion == pytest.approx(beyond, abs=1e-9)
    # not exactly at the tolerance, where rounding decides
    if abs(beyond - TOLERANCE) > 1e-6:
        assert end.is_contained == (beyond < TOLERANCE)


@given(
    p=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.0, 0.4)),
    vector=st.tuples(*[st.floats(-3.0, 3.0)] * 3),
)
def test_a_pose_never_measures_less_than_nothing(
    p: tuple[float, float, float], vector: tuple[float, float, float]
) -> None:
    q = rotations.exp(vector)
    end = end_at(TARGET + np.array(p), q)
    corners = Pose(TARGET + np.array(p), q).apply(ITEM.hull())
    is_between = np.all((corners[:, :2] >= CONTAINER.lower) & (corners[:, :2] <= CONTAINER.upper))
    assert end.protrusion >= 0.0
    assert (end.protrusion == 0.0) == is_between
    assert 0.0 <= end.tilt <= np.pi
    assert end.top_over_rim >= end.centre_over_rim


@given(angle=st.floats(0.0, np.pi), yaw=st.floats(-np.pi, np.pi))
def test_tilt_is_the_angle_of_the_axis_whatever_the_yaw(angle: float, yaw: float) -> None:
    q = rotations.multiply(rotations.exp([angle, 0.0, 0.0]), rotations.from_yaw(yaw))
    # near 0 and 180 degrees the arc cosine takes the square root of the rounding error
    assert end_at(TARGET, q).tilt == pytest.approx(angle, abs=1e-7)


def test_an_object_that_leans_over_the_rim_sticks_out() -> None:
    angle = 0.5
    p = TARGET + np.array([ROOM[0], 0.0, 0.03])
    end = end_at(p, rotations.exp([0.0, angle, 0.0]))
    # the upper edge of the leaning box: half width times cosine and half height times sine
    reach = HALF[0] * np.cos(angle) + HALF[2] * np.sin(angle)
    assert end.protrusion == pytest.approx(reach - HALF[0])
    assert not end.is_contained


def test_an_object_on_top_of_the_others_is_not_contained() -> None:
    end = end_at(TARGET + np.array([0.0, 0.0, 0.05]))
    assert end.protrusion == 0.0
    assert end.centre_over_rim > 0.0
    assert not end.is_contained


def test_the_end_counts_not_the_way_there() -> None:
    track = RUN.truth[RUN.held]
    early = track.times < RUN.end - 0.1
    p = np.where(early[:, None], TARGET + np.array([0.3, 0.0, 0.0]), TARGET)
    assert containment(replace(RUN, truth={**RUN.truth, RUN.held: replace(track, p=p)})).is_contained
