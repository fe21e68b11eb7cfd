"""Meshes as shapes: read from files, refused with the reason, and the same wherever they are used."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh
import yaml

from pack_core.errors import ConfigError
from pack_core.hull import hull_of
from pack_core.packing.cell import packing_cell
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.object_set import can_be_packed, load_set
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene, parse_scene, scene_text
from pack_core.text.limits import MOST_MESH_CORNERS

HOUSEHOLD = {item.name: item for item in load_set("household").objects}
WEDGE = np.array([[x, y, z] for y in (0, 40) for x, z in ((0, 0), (90, 0), (60, 70))], float)

BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def write_scene(folder: Path, **item: object) -> Path:
    """A scene file whose new object is a mesh."""
    scene = {
        "container": {"size": [0.27, 0.22], "height": 0.12}, "friction": 0.4, "objects": [],
        "new_object": {"name": "thing", "shape": "mesh", "mass": 0.3, **item},
    }  # fmt: skip
    path = folder / "scene.yaml"
    path.write_text(yaml.safe_dump(scene))
    return path


def write_mesh(folder: Path, name: str, points: np.ndarray = WEDGE) -> str:
    trimesh.PointCloud(points).convex_hull.export(folder / name)
    return name


@pytest.mark.parametrize("name", ["wedge.stl", "wedge.obj", "WEDGE.OBJ"])
def test_a_mesh_beside_the_scene_file_becomes_its_hull_about_the_middle_of_its_box(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / "parts").mkdir()
    write_mesh(tmp_path / "parts", name)
    item = load_scene(write_scene(tmp_path, file=f"parts/{name}", scale=0.001)).new_object
    assert isinstance(item, ConvexMesh)
    np.testing.assert_allclose(2 * item.half_extents, [0.09, 0.04, 0.07], atol=1e-6)
    expected = WEDGE / 1000 - [0.045, 0.02, 0.035]
    assert {tuple(p) for p in np.round(item.hull(), 6).tolist()} == {
        tuple(p) for p in np.round(expected, 6).tolist()
    }
    # the centroid of a triangle is the mean of its corners
    np.testing.assert_allclose(item.centre_of_mass, [0.005, 0.0, 0.07 / 3 - 0.035], atol=1e-6)


def test_the_text_that_is_sent_has_corners_and_describes_the_same_scene(tmp_path: Path) -> None:
    write_mesh(tmp_path, "wedge.stl")
    path = write_scene(tmp_path, file="wedge.stl", scale=0.001)
    text = scene_text(path)
    assert "wedge.stl" not in text
    assert parse_scene(text, "sent") == load_scene(path)


def test_a_text_without_a_folder_may_name_no_file(tmp_path: Path) -> None:
    write_mesh(tmp_path, "wedge.stl")
    text = write_scene(tmp_path, file="wedge.stl", scale=0.001).read_text()
    with pytest.raises(ConfigError, match=r"request.*`vertices`; `file` 'wedge\.stl' is for files"):
        parse_scene(text, "request")


FLAT = WEDGE * [1.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("item", "reason"),
    [
        ({"file": "none.stl"}, "`file` that is there"),
        ({"file": "text.stl"}, "has none|cannot be read"),
        ({"file": "text.obj"}, "has none|cannot be read"),
        ({"file": "wedge.ply"}, r"ends in \.stl or \.obj"),
        ({"file": "wedge.stl"}, "5 mm to 2 m"),
        ({"file": "wedge.stl", "scale": 1e-5}, "5 mm to 2 m"),
        ({"file": "wedge.stl", "scale": -1.0}, "scale"),
        ({"file": "wedge.stl", "scale": "big"}, "scale"),
        ({"file": "flat.obj", "scale": 0.001}, "span a volume"),
        ({"file": "large.stl", "scale": 0.001}, "up to 20 MB"),
        ({"file": "nan.obj", "scale": 0.001}, "finite"),
        ({"file": ["wedge.stl"]}, "a text"),
        ({"file": "wedge.stl", "vertices": [[0, 0, 0]] * 4}, "either `file`"),
        ({"vertices": [[0, 0, 0]] * 4}, "5 mm to 2 m"),
        ({"vertices": [[0, 0, 0]] * 3}, "at least 4"),
        ({"vertices": (WEDGE / 1000).tolist()}, "middle of their bounding box"),
        ({}, "either `file`, an STL or OBJ file, or `vertices`"),
        ({"vertices": (0.1 * BOX).tolist(), "scale": 0.001}, "scale' is not known"),
        ({"file": "a\0b.stl"}, "`file` that is there"),
        ({"file": "."}, "`file` that is there"),
    ],
)
def test_what_is_no_sound_mesh_is_refused_with_the_reason(
    tmp_path: Path, item: dict[str, object], reason: str
) -> None:
    write_mesh(tmp_path, "wedge.stl")
    (tmp_path / "text.stl").write_text("no mesh at all")
    (tmp_path / "text.obj").write_text("no mesh at all")
    (tmp_path / "wedge.ply").write_text("ply")
    (tmp_path / "large.stl").write_bytes(bytes(20_000_001))
    (tmp_path / "nan.obj").write_text("v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 2 3 4\n")
    (tmp_path / "flat.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in FLAT) + "f 1 2 3\nf 4 5 6\nf 1 2 5\n"
    )
    with pytest.raises(ConfigError, match=reason) as refusal:
        load_scene(write_scene(tmp_path, **item))
    assert "new_object" in str(refusal.value)


def test_a_fine_mesh_keeps_its_size_and_few_corners(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=40.0)
    ball.export(tmp_path / "ball.stl")
    item = load_scene(write_scene(tmp_path, file="ball.stl", scale=0.001)).new_object
    assert len(item.hull()) == MOST_MESH_CORNERS
    np.testing.assert_allclose(item.half_extents, 0.04, atol=1e-6)
    outside = hull_of(item.hull()).heights(ball.vertices / 1000)
    assert outside.max() < 0.0015


@pytest.mark.parametrize("name", ["bottle_250", "mustard_bottle", "cucumber"])
def test_mass_and_inertia_in_the_model_are_those_of_the_filled_body(name: str) -> None:
    item = HOUSEHOLD[name]
    scene = packing_cell().scene.model_copy(update={"objects": [], "new_object": item})
    model = build_model(scene, packing_cell(), timestep=0.002, arm=ArmRole.ABSENT, held=HeldRole.FREE)
    body = trimesh.PointCloud(item.hull()).convex_hull
    body.density = item.mass / body.volume
    found = model.body(name)
    assert found.mass == pytest.approx(item.mass)
    np.testing.assert_allclose(found.ipos, body.center_mass, atol=1e-6)
    expected = sorted(np.linalg.eigvalsh(body.moment_inertia))
    np.testing.assert_allclose(sorted(found.inertia.ravel()), expected, rtol=0.01)


def test_symmetry_tells_round_bodies_from_others() -> None:
    assert HOUSEHOLD["bottle_250"].symmetry == 0.0
    assert HOUSEHOLD["meat_can"].symmetry == pytest.approx(np.pi)
    wedge = WEDGE / 1000 - [0.045, 0.02, 0.035]
    item = ConvexMesh(name="w", shape="mesh", mass=0.1, vertices=tuple(map(tuple, wedge.tolist())))
    assert item.symmetry == pytest.approx(2 * np.pi)


def test_the_set_has_twenty_objects_of_four_shapes_and_the_pump_carries_some() -> None:
    assert len(HOUSEHOLD) == 20
    assert {item.shape for item in HOUSEHOLD.values()} == {"box", "cylinder", "capsule", "mesh"}
    packable = {name for name, item in HOUSEHOLD.items() if can_be_packed(item, packing_cell())}
    assert {"coffee_can", "meat_can", "bottle_250"} < packable
    assert not packable & {"lemon", "pear", "mustard_bottle", "tuna_can"}


@pytest.mark.parametrize("item", HOUSEHOLD.values(), ids=HOUSEHOLD.keys())
def test_each_object_of_the_set_stays_where_it_stands(item: ConvexMesh) -> None:
    scene = packing_cell().scene.model_copy(update={"objects": [], "new_object": item})
    model = build_model(scene, packing_cell(), timestep=0.002, arm=ArmRole.ABSENT, held=HeldRole.FREE)
    data = mujoco.MjData(model)
    data.joint(item.name).qpos[:3] = [0.5, 0.0, item.half_extents[2]]
    mujoco.mj_step(model, data, 500)
    assert np.linalg.norm(data.body(item.name).xpos - [0.5, 0.0, item.half_extents[2]]) < 0.002
    assert abs(data.body(item.name).xmat[8]) > np.cos(np.deg2rad(3.0))
    Scene.from_yaml(scene.to_yaml())
