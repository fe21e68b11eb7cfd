"""Free places by Minkowski sums, against closed forms."""

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.free_space import (
    base_height,
    fitting_yaws,
    footprint,
    free_places,
    is_blocked,
    is_inside,
)
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.scene import Container, Scene
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose, exp, from_yaw

CONTAINER = Container(size=(0.30, 0.20), height=0.12)
BRICK = Box(name="brick", shape="box", size=(0.10, 0.06, 0.08), mass=0.3)
CAN = Cylinder(name="can", shape="cylinder", radius=0.03, height=0.11, mass=0.3)
MIDDLE = Pose(np.array([0.5, 0.0, 0.05]))


def scene_of(*items: Box | Cylinder, new: Box | Cylinder) -> Scene:
    """A scene with objects anywhere."""
    return Scene(container=CONTAINER, friction=0.4, objects=list(items), new_object=new)


def test_an_upright_box_has_the_outline_of_its_base() -> None:
    outline = footprint(BRICK, Pose(np.array([0.5, 0.1, 0.04]), from_yaw(np.pi / 2)))
    np.testing.assert_allclose(outline.bounds, [0.47, 0.05, 0.53, 0.15], atol=1e-12)


def test_a_lying_can_has_a_rectangular_outline_and_stands_on_its_side() -> None:
    lying = Pose(np.array([0.5, 0.0, 0.03]), exp([0.0, np.pi / 2, 0.0]))
    assert footprint(CAN, lying).area == pytest.approx(0.11 * 0.06, rel=1e-9)
    assert base_height(CAN, lying) == pytest.approx(0.0, abs=1e-12)


def test_an_empty_container_leaves_its_base_less_half_the_object_to_each_side() -> None:
    free = free_places(BRICK, 0.0, CONTAINER, [])
    assert free.area == pytest.approx((0.30 - 0.10) * (0.20 - 0.06))


def test_a_box_in_the_middle_takes_its_size_plus_the_objects() -> None:
    free = free_places(BRICK, 0.0, CONTAINER, [footprint(BRICK, MIDDLE)])
    assert free.area == pytest.approx(0.20 * 0.14 - 0.20 * 0.12)


def test_an_object_wider_than_the_container_has_no_free_place() -> None:
    wide = BRICK.model_copy(update={"size": (0.25, 0.21, 0.05)})
    assert free_places(wide, 0.0, CONTAINER, []).is_empty


def test_a_gap_that_is_free_at_one_yaw_only_is_found() -> None:
    """The brick fits beside a wide obstacle lengthwise, and at no other yaw."""
    wide = Box(name="wide", shape="box", size=(0.235, 0.20, 0.1), mass=1.0)
    placed = scene_of(wide, new=BRICK).with_poses({"wide": Pose(np.array([0.35 + 0.1175, 0.0, 0.05]))})
    assert not is_blocked(placed)
    assert free_places(BRICK, 0.0, CONTAINER, [footprint(wide, Pose(np.array([0.4675, 0.0, 0.05])))]).is_empty


def test_a_gap_slightly_too_narrow_is_blocked() -> None:
    wide = Box(name="wide", shape="box", size=(0.2415, 0.20, 0.1), mass=1.0)
    placed = scene_of(wide, new=BRICK).with_poses({"wide": Pose(np.array([0.35 + 0.12075, 0.0, 0.05]))})
    assert is_blocked(placed)


def test_outlines_over_a_wall_are_not_inside() -> None:
    beside_wall = Pose(np.array([0.40, 0.0, 0.04]))
    assert is_inside(footprint(BRICK, beside_wall), CONTAINER, 1e-9)
    assert not is_inside(footprint(BRICK, Pose(beside_wall.p - [0.001, 0.0, 0.0])), CONTAINER)


def test_symmetries_are_none_a_quarter_and_half_a_turn() -> None:
    square = BRICK.model_copy(update={"size": (0.06, 0.06, 0.08)})
    assert [item.symmetry for item in (CAN, square, BRICK)] == [0.0, np.pi / 2, np.pi]


def test_fitting_yaws_leave_out_those_at_which_the_object_is_too_long() -> None:
    long = BRICK.model_copy(update={"size": (0.25, 0.05, 0.05)})
    yaws = fitting_yaws(long, CONTAINER, 0.0)
    assert np.all(2 * long.half_spans(yaws) <= np.array(CONTAINER.size) + 1e-12)
    assert np.abs(yaws).max() < np.pi / 2


def test_the_example_is_blocked_and_the_empty_container_is_not() -> None:
    example = load_scene(config_path("scenarios", "packing", "example.yaml"))
    assert is_blocked(example)
    assert not is_blocked(packing_cell().scene.model_copy(update={"objects": []}))
