"""Shapes: what they say of themselves fits together, and one that says too little is refused."""

from typing import get_args

import mujoco
import numpy as np
import pytest
from pydantic import ValidationError

from pack_core.config import parse_config
from pack_core.errors import ConfigError
from pack_core.packing.objects import TOP_MARKERS, Box, Cylinder, ObjectModel, SceneItem
from pack_core.packing.scene import Scene

BRICK = Box(name="brick", shape="box", size=(0.10, 0.06, 0.08), mass=0.3)
CAN = Cylinder(name="can", shape="cylinder", radius=0.03, height=0.11, mass=0.3)
ITEMS: tuple[SceneItem, ...] = (BRICK, CAN)


def test_every_shape_is_tried_here() -> None:
    assert {type(item) for item in ITEMS} == set(get_args(get_args(ObjectModel)[0]))


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_hull_bounds_spans_and_geometry_are_of_one_body(item: SceneItem) -> None:
    np.testing.assert_allclose(np.ptp(item.hull(), axis=0), 2 * item.half_extents, rtol=1e-12)
    np.testing.assert_allclose(item.half_spans(np.zeros(1))[0], item.half_extents[:2], rtol=1e-12)
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(name=item.name, type=item.geom_type, size=item.geom_size)
    model = spec.compile()
    np.testing.assert_allclose(model.geom_aabb[0, 3:], item.half_extents, rtol=1e-12)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_a_turn_by_its_symmetry_changes_no_outline(item: SceneItem) -> None:
    yaws = np.linspace(0.0, np.pi, 7)
    np.testing.assert_allclose(item.half_spans(yaws + item.symmetry), item.half_spans(yaws), atol=1e-12)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_markers_stand_off_the_surface_the_first_ones_on_top(item: SceneItem) -> None:
    p_BM = item.markers()
    assert p_BM.shape == (6, 3)
    assert np.all(p_BM[:TOP_MARKERS, 2] > item.half_extents[2])
    assert np.all(p_BM[TOP_MARKERS:, 2] < item.half_extents[2])


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_a_resized_object_differs_by_the_change(item: SceneItem) -> None:
    change = np.array([0.002, 0.002, -0.001])
    np.testing.assert_allclose(
        2 * (item.resized(change).half_extents - item.half_extents), change, atol=1e-15
    )


def test_a_shape_that_leaves_something_out_cannot_be_made() -> None:
    class Blob(SceneItem):
        pass

    with pytest.raises(TypeError, match=r"abstract.*geom_size"):
        Blob(name="blob", mass=1.0)  # type: ignore[abstract]


def test_a_scene_file_with_an_unknown_shape_is_refused_with_the_known_ones() -> None:
    text = (
        "{container: {size: [0.3, 0.2], height: 0.1}, friction: 0.4, objects: [], "
        "new_object: {name: egg, shape: egg, mass: 0.1}}"
    )
    with pytest.raises(ConfigError, match=r"'box', 'cylinder'"):
        parse_config(Scene, text, "scene")
    with pytest.raises(ValidationError):
        Box(name="egg", shape="egg", size=(0.1, 0.1, 0.1), mass=0.1)  # type: ignore[arg-type]
