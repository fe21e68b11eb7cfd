"""The models of the cells as the browser is sent them."""

import io

import mujoco
import numpy as np
import pytest
import trimesh

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import build_model as build_blocks
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model as build_palletizing
from pack_viewer.geom_meshes import body_glb, box_glb, visible_geoms
from pack_viewer.model_scene import scene_name

SHAPES = {
    "box": (mujoco.mjtGeom.mjGEOM_BOX, (0.1, 0.2, 0.3), (0.1, 0.2, 0.3)),
    "sphere": (mujoco.mjtGeom.mjGEOM_SPHERE, (0.2,), (0.2, 0.2, 0.2)),
    "cylinder": (mujoco.mjtGeom.mjGEOM_CYLINDER, (0.1, 0.3), (0.1, 0.1, 0.3)),
    "capsule": (mujoco.mjtGeom.mjGEOM_CAPSULE, (0.1, 0.3), (0.1, 0.1, 0.4)),
    "ellipsoid": (mujoco.mjtGeom.mjGEOM_ELLIPSOID, (0.1, 0.2, 0.3), (0.1, 0.2, 0.3)),
}


def drawn(glb: bytes) -> trimesh.Trimesh:
    return trimesh.load(io.BytesIO(glb), file_type="glb").to_mesh()


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_is_as_large_as_mujoco_has_it_and_in_its_place(name: str) -> None:
    kind, size, half = SHAPES[name]
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=kind, size=[*size, 0, 0][:3], pos=(1, 2, 3))
    mesh = drawn(body_glb(spec.compile(), [0]))
    low, high = np.array([1, 2, 3]) - half, np.array([1, 2, 3]) + half
    assert mesh.bounds == pytest.approx(np.array([low, high]), abs=0.01)


def test_a_turned_geom_is_drawn_turned() -> None:
    spec = mujoco.MjSpec()
    half_turn_of_90 = (np.sqrt(0.5), 0, 0, np.sqrt(0.5))
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.1, 0.2, 0.3), quat=half_turn_of_90)
    mesh = drawn(body_glb(spec.compile(), [0]))
    assert mesh.extents == pytest.approx([0.4, 0.2, 0.6])


@pytest.mark.parametrize("cell", ["palletizing", "blocks"])
def test_every_visible_body_of_a_cell_can_be_drawn(cell: str) -> None:
    model = (
        build_palletizing(palletizing_cell(), visuals=True)
        if cell == "palletizing"
        else build_blocks(blocks_cell(), {"a": 3}, timestep=0.001, visuals=True)
    )
    sizes = [
        len(body_glb(model, geoms)) for body in range(model.nbody) if (geoms := visible_geoms(model, body))
    ]
    assert len(sizes) > 5
    assert sum(sizes) < 6e6  # what a browser loads first


def test_what_only_collides_and_what_is_transparent_is_not_drawn() -> None:
    spec = mujoco.MjSpec()
    sphere = dict(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(0.1, 0, 0))
    spec.worldbody.add_geom(**sphere, group=3)
    spec.worldbody.add_geom(**sphere, rgba=(1, 0, 0, 0))
    spec.worldbody.add_geom(**sphere)
    assert visible_geoms(spec.compile(), 0) == [2]


def test_boxes_of_cardboard_carry_a_picture() -> None:
    model = build_palletizing(palletizing_cell(), visuals=True)
    printed = drawn(box_glb(model, np.array([0.2, 0.1, 0.1]), material="cardboard_0"))
    assert printed.visual.material.baseColorTexture is not None
    assert printed.extents == pytest.approx([0.4, 0.2, 0.2])


def test_a_name_is_one_step_of_a_path_in_the_scene() -> None:
    assert "/" not in scene_name("a/b")
    assert scene_name("block a1") == "block a1"
