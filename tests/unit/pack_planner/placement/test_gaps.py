"""What enters first, and how much of it is over others."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from pack_core.packing.cell import packing_cell
from pack_core.packing.entry import WayIn
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, from_yaw
from pack_planner.placement.approach_options import ENTERS_FIRST, covered, first_parts
from pack_planner.placement.placement_result import PlacementCandidate

WIDTH, LENGTH = 0.05, 0.08
NEW = Box(name="new", shape="box", size=(LENGTH, WIDTH, 0.16), mass=0.3)
OTHER = Box(name="other", shape="box", size=(0.04, 0.20, 0.12), mass=0.3)
CENTRE = np.array([0.5, 0.0])


def option(
    x: float = 0.5, yaw: float = 0.0, lean: float = 0.0, back: float = 0.0, side: float = 0.0
) -> PlacementCandidate:
    """A placement that leans to the side at this angle [rad]."""
    way = WayIn(np.array([math.cos(side), math.sin(side)]), lean, back)
    return PlacementCandidate(Pose(np.array([x, 0.0, 0.08]), from_yaw(yaw)), (), 0.0, way=way)


@pytest.fixture
def scene() -> Scene:
    """A wall of a box at x = 0.56 to 0.60 in a container from x = 0.365 to 0.635."""
    empty = packing_cell().scene.model_copy(update={"objects": [OTHER], "new_object": NEW})
    return empty.with_poses({"other": Pose(np.array([0.58, 0.0, 0.06]))})


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_upright_the_whole_lower_face_enters_first(yaw: float, side: float) -> None:
    part = first_parts(NEW, [option(yaw=yaw, side=side)])[0]
    assert part.area == pytest.approx(WIDTH * LENGTH)
    np.testing.assert_allclose([part.centroid.x, part.centroid.y], CENTRE, atol=1e-9)


@given(st.floats(0.4, 1.1), st.floats(0.0, 0.08))
def test_tilted_a_strip_along_the_lowest_edge_enters_first(lean: float, back: float) -> None:
    """At height h over the edge the section reaches h / tan along the lower face, h tan along the side."""
    part = first_parts(NEW, [option(lean=lean, back=back)])[0]
    below, aside = ENTERS_FIRST / math.tan(lean), ENTERS_FIRST * math.tan(lean)
    edge = CENTRE[0] - back + 0.5 * LENGTH * math.cos(lean)
    np.testing.assert_allclose(
        part.bounds, [edge - below, -0.5 * WIDTH, edge + aside, 0.5 * WIDTH], atol=1e-9
    )
    assert part.area == pytest.approx(WIDTH * (below + aside))


def test_a_can_enters_with_a_part_as_broad_as_itself_at_most() -> None:
    can = Cylinder(name="can", shape="cylinder", radius=0.03, height=0.1, mass=0.3)
    outlines = first_parts(can, [option(lean=0.6, side=0.1 * k) for k in range(10)])
    assert np.ptp(shapely.area(outlines)) < 0.05 * shapely.area(outlines).mean()
    assert shapely.area(outlines).max() < math.pi * 0.03**2


def test_covered_is_what_is_over_others_or_beyond_the_walls(scene: Scene) -> None:
    free, onto, beyond = (WIDTH * LENGTH * share for share in (0.0, 0.25, 0.5))
    options = [option(), option(x=0.54), option(x=0.365)]
    np.testing.assert_allclose(covered(scene, scene.poses(), options), [free, onto, beyond], atol=1e-9)


def test_the_offset_of_the_entry_counts_not_the_place(scene: Scene) -> None:
    onto, off = option(x=0.56), option(x=0.56, back=0.06)
    assert covered(scene, scene.poses(), [onto])[0] == pytest.approx(0.5 * WIDTH * LENGTH)
    assert covered(scene, scene.poses(), [off])[0] == pytest.approx(0.0, abs=1e-9)
