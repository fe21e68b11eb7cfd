"""Shapes: what they say of themselves fits together, and one that says too little is refused."""

from typing import get_args

import mujoco
import numpy as np
import pytest
from pydantic import ValidationError

from pack_core.config import parse_config
from pack_core.errors import ConfigError
from pack_core.hull import hull_of
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.objects import Box, Capsule, Cylinder, ObjectModel
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import MARKER_HEIGHT, TOP_MARKERS, SceneItem

BRICK = Box(name="brick", shape="box", size=(0.10, 0.06, 0.08), mass=0.3)
CAN = Cylinder(name="can", shape="cylinder", radius=0.03, height=0.11, mass=0.3)
SAUSAGE = Capsule(name="sausage", shape="capsule", radius=0.03, length=0.16, axis="x", mass=0.3)
TUBE = Capsule(name="tube", shape="capsule", radius=0.03, length=0.16, mass=0.3)
WEDGE = ConvexMesh(
    name="wedge", shape="mesh", mass=0.3,
    vertices=tuple(
        (x, y, z) for y in (-0.03, 0.03) for x, z in ((-0.05, -0.04), (0.05, -0.04), (0.02, 0.04))
    ),
)  # fmt: skip
ITEMS: tuple[SceneItem, ...] = (BRICK, CAN, SAUSAGE, TUBE, WEDGE)


def test_every_shape_is_tried_here() -> None:
    assert {type(item) for item in ITEMS} == set(get_args(get_args(ObjectModel)[0]))


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_hull_bounds_spans_and_geometry_are_of_one_body(item: SceneItem) -> None:
    np.testing.assert_allclose(np.ptp(item.hull(), axis=0), 2 * item.half_extents, rtol=1e-12)
    np.testing.assert_allclose(item.half_spans(np.zeros(1))[0], item.half_extents[:2], rtol=1e-12)
    spec = mujoco.MjSpec()
    spec.worldbody.add_body(name=item.name).add_geom(name=item.name, mass=item.mass, **item.geometry(spec))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hull, normals = hull_of(item.hull()), np.concatenate([np.eye(3), -np.eye(3)])
    points, _ = hull.exits(hull.centroid, normals)
    for p, n in zip(points, normals, strict=True):
        way = mujoco.mj_ray(model, data, p + 0.1 * n, -n, None, True, -1, np.zeros(1, np.int32), None)
        assert way == pytest.approx(0.1, abs=1e-4)
    np.testing.assert_allclose(model.body(item.name).ipos, item.centre_of_mass, atol=1e-6)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_a_turn_by_its_symmetry_changes_no_outline(item: SceneItem) -> None:
    yaws = np.linspace(0.0, np.pi, 7)
    np.testing.assert_allclose(item.half_spans(yaws + item.symmetry), item.half_spans(yaws), atol=1e-12)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_markers_stand_off_the_surface_the_first_ones_on_top(item: SceneItem) -> None:
    p_BM = item.markers()
    assert p_BM.shape == (6, 3)
    np.testing.assert_allclose(hull_of(item.hull()).heights(p_BM), MARKER_HEIGHT, atol=2e-4)
    assert p_BM[:TOP_MARKERS, 2].min() > p_BM[TOP_MARKERS:, 2].max()


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_a_resized_object_differs_by_the_change(item: SceneItem) -> None:
    # a capsule that lies is as high as it is wide
    change = np.array([0.002, 0.001, 0.001]) if item is SAUSAGE else np.array([0.002, 0.002, -0.001])
    np.testing.assert_allclose(
        2 * (item.resized(change).half_extents - item.half_extents), change, atol=1e-15
    )


def test_a_shape_that_leaves_something_out_cannot_be_made() -> None:
    class Blob(SceneItem):
        pass

    with pytest.raises(TypeError, match=r"abstract.*geometry"):
        Blob(name="blob", mass=1.0)  # type: ignore[abstract]


def test_a_scene_file_with_an_unknown_shape_is_refused_with_the_known_ones() -> None:
    text = (
        "{container: {size: [0.3, 0.2], height: 0.1}, friction: 0.4, objects: [], "
        "new_object: {name: egg, shape: egg, mass: 0.1}}"
    )
    with pytest.raises(ConfigError, match=r"'box', 'cylinder', 'capsule', 'mesh'"):
        parse_config(Scene, text, "scene")
    with pytest.raises(ValidationError):
        Box(name="egg", shape="egg", size=(0.1, 0.1, 0.1), mass=0.1)  # type: ignore[arg-type]


def test_objects_without_a_colour_can_be_told_apart_and_keep_theirs() -> None:
    size = (0.05, 0.05, 0.1)
    tea, rice = (Box(name=name, mass=0.3, shape="box", size=size) for name in ("tea", "rice"))
    assert tea.colour == Box(name="tea", mass=0.5, shape="box", size=size).colour
    assert np.abs(np.array(tea.colour) - rice.colour).max() > 0.1
    assert Box(name="tea", mass=0.3, shape="box", size=size, colour=(0.1, 0.2, 0.3)).colour == (0.1, 0.2, 0.3)
