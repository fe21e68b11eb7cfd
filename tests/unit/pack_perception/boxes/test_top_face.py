"""From exact outlines the top face's pose is exact, also where the sides of the box stick out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.rotations import Array
from pack_perception.boxes.edge_line import EdgeLine
from pack_perception.boxes.top_face import TopPose, Viewpoint, measure_span, top_poses

CAMERA_HEIGHT = 3.0


def edge(start: Array, end: Array) -> EdgeLine:
    length = float(np.linalg.norm(end - start))
    return EdgeLine(0.5 * (start + end), (end - start) / length, length, 1.0, 100.0, 180.0)


def outline(yaw: float, centre: Array, dims: tuple[float, float, float], shows_sides: bool) -> list[EdgeLine]:
    """Edges of a box's picture on the plane of its top face, its camera above the origin."""
    axes = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = centre + (0.5 * np.array(dims[:2]) * signs) @ axes
    edges = []
    for k in range(4):
        start, end = corners[k], corners[(k + 1) % 4]
        outward = np.array([end[1] - start[1], start[0] - end[0]])
        if (
            shows_sides and outward @ start < 0.0
        ):  # the origin is on the outer side: the base is seen beyond it
            scale = 1.0 - dims[2] / CAMERA_HEIGHT
            start, end = start * scale, end * scale
        edges.append(edge(start, end))
    return edges


def best(edges: list[EdgeLine], dims: tuple[float, float, float]) -> TopPose:
    view = Viewpoint(np.zeros(2), dims[2] / CAMERA_HEIGHT)
    return min(top_poses(edges, dims[:2], view), key=lambda pose: pose.mismatch)


@given(
    yaw=st.floats(-1.5, 1.5), x=st.floats(-0.3, 0.3), y=st.floats(-0.3, 0.3), shows_sides=st.booleans(),
    d_y=st.floats(0.1, 0.35), d_z=st.floats(0.05, 0.3), first=st.integers(0, 3),
)  # fmt: skip
def test_an_exact_outline_gives_the_exact_pose(
    yaw: float, x: float, y: float, shows_sides: bool, d_y: float, d_z: float, first: int
) -> None:
    dims = (0.4, d_y, d_z)
    edges = outline(yaw, np.array([x, y]), dims, shows_sides)
    pose = best(edges[first:] + edges[:first], dims)
    np.testing.assert_allclose(pose.centre, [x, y], atol=1e-4)  # a side may stick out unseen by this much
    assert pose.yaw == pytest.approx(yaw, abs=1e-9)
    assert pose.mismatch < 2e-4
    assert len(pose.sure) >= 2


def test_a_span_whose_sides_are_hidden_is_measured_between_its_edges() -> None:
    span = measure_span(1.0, 1.403, 0.4, 1.2, 0.1)
    assert (span.middle, span.is_sure) == (pytest.approx(1.2015), (True, True))
    assert span.mismatch == pytest.approx(0.003)


@pytest.mark.parametrize(("low", "high", "is_sure"), [(0.1, 0.3, (False, True)), (-0.3, -0.1, (True, False))])
def test_a_span_beside_the_camera_rests_on_its_far_edge(
    low: float, high: float, is_sure: tuple[bool, bool]
) -> None:
    seen = (
        (low - 0.1 * low, high) if low > 0.0 else (low, high - 0.1 * high)
    )  # the base is seen at the near one
    for ends in ((low, high), seen):
        span = measure_span(*ends, expected=0.2, foot=0.0, slope=0.1)
        assert span.middle == pytest.approx(0.5 * (low + high))
        assert span.is_sure == is_sure
        assert span.mismatch == pytest.approx(0.0, abs=1e-12)


def test_a_size_that_fits_neither_edge_nor_base_is_a_mismatch() -> None:
    assert measure_span(0.1, 0.305, expected=0.2, foot=0.0, slope=0.1).mismatch == pytest.approx(
        0.005, abs=6e-4
    )
    assert measure_span(0.08, 0.3, expected=0.2, foot=0.0, slope=0.1).mismatch == pytest.approx(
        0.01, abs=1e-9
    )


@pytest.mark.parametrize("yaw_deg", [-89.0, -45.0, 0.0, 30.0, 90.0])
def test_yaw_is_that_of_the_long_side_and_never_more_than_a_quarter_turn(yaw_deg: float) -> None:
    dims = (0.4, 0.3, 0.2)
    pose = best(outline(np.deg2rad(yaw_deg), np.zeros(2), dims, False), dims)
    assert np.rad2deg(pose.yaw) == pytest.approx(yaw_deg)
