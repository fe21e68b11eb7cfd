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


CUBE = "".join(f"v {x} {y} {z}\n" for x, y, z in 20 * BOX)
SIDES = ((1, 2, 4, 3), (5, 6, 8, 7), (1, 2, 6, 5), (3, 4, 8, 7), (1, 3, 7, 5), (2, 4, 8, 6))
TOWER = CUBE.replace("20.0", "10.0")


def faces(first: int = 0) -> str:
    return "".join("f " + " ".join(str(k + first) for k in side) + "\n" for side in SIDES)


def sides_of(folder: Path, name: str, content: str | bytes) -> list[float]:
    """Sides [mm] of the body in a mesh file."""
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return np.round(
        2000 * load_scene(write_scene(folder, file=name, scale=0.001)).new_object.half_extents, 3
    ).tolist()


@pytest.mark.parametrize(
    "text",
    [
        CUBE + faces(),
        CUBE + faces(-9),
        "\ufeff" + CUBE + faces(),
        CUBE.replace(" ", "\t").replace("\n", "\r\n") + faces().replace("f ", "f\t\t"),
        "v 900 0 0\n" + CUBE + faces(1),  # which no face names
        CUBE.replace("\n", " 1.0 0.5 0.5\n") + "usemtl straße\n" + faces().replace(" 1", " 1/1/1"),
        CUBE + "f 1 2 \\\n4 3\n" + faces()[faces().index("\n") + 1 :],
        CUBE + faces(-9) + TOWER + faces(-9),
    ],
    ids=["plain", "relative", "mark", "tabs", "unused", "normals", "continued", "two relative bodies"],
)  # fmt: skip
def test_all_ways_to_write_an_obj_file_give_the_same_body(text: str, tmp_path: Path) -> None:
    assert sides_of(tmp_path, "cube.obj", text) == [40.0, 40.0, 40.0]


def test_relative_indices_count_back_from_their_face(tmp_path: Path) -> None:
    upper = CUBE.replace(" 20.0\n", " 100.0\n").replace(" -20.0\n", " 20.0\n")
    assert sides_of(tmp_path, "two.obj", CUBE + faces(-9) + upper + faces(-9)) == [40.0, 40.0, 120.0]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (CUBE + faces(-1), r"line 9: a face names vertex 0; allowed: from 1, or from -1 to -8"),
        (CUBE + "f -9 1 2\n", r"line 9: a face names vertex -9"),
        (CUBE + faces(1), r"a face names vertex 9, but there are 8"),
        (CUBE + "f 1 2\n", r"line 9: a face of 2 vertices; allowed: 3 or more"),
        (CUBE + "f 1 2 x\n", r"line 9: a face with 'x'"),
        (CUBE + "v 1 2\n" + faces(), r"line 9: a vertex of 2 coordinates"),
        (CUBE + "v 1 2 z\n" + faces(), r"line 9: a vertex '1 2 z'; allowed: three numbers"),
        (CUBE, "has none"),
    ],
)
def test_an_obj_file_that_cannot_be_meant_is_refused_with_its_line(
    text: str, reason: str, tmp_path: Path
) -> None:
    with pytest.raises(ConfigError, match=reason):
        sides_of(tmp_path, "cube.obj", text)


def ascii_solid(name: str = "part", scale: float = 1.0) -> str:
    """A wedge as an STL text."""
    mesh = trimesh.PointCloud(scale * WEDGE).convex_hull
    return f"solid {name}\n" + str(trimesh.exchange.stl.export_stl_ascii(mesh)).partition("\n")[2]


def test_all_solids_of_an_stl_text_belong_to_the_body(tmp_path: Path) -> None:
    two = ascii_solid("one") + "\n" + ascii_solid("two", 2.0)
    assert sides_of(tmp_path, "two.stl", two) == [180.0, 80.0, 140.0]
    assert sides_of(tmp_path, "tabs.stl", two.replace(" ", "\t").replace("\n", "\r\n").upper()) == [
        180.0,
        80.0,
        140.0,
    ]
    assert sides_of(tmp_path, "mark.stl", "\ufeff" + two) == [180.0, 80.0, 140.0]


@pytest.mark.parametrize("share", [0.3, 0.55, 0.9])
def test_an_stl_text_that_was_cut_off_is_refused(share: float, tmp_path: Path) -> None:
    two = ascii_solid("one") + "\n" + ascii_solid("two", 2.0)
    with pytest.raises(ConfigError, match="cannot be read as one"):
        sides_of(tmp_path, "two.stl", two[: int(share * len(two))])


@pytest.mark.parametrize("change", [-50, -1, 1, 50])
def test_a_binary_stl_file_has_the_length_that_it_tells(change: int, tmp_path: Path) -> None:
    write_mesh(tmp_path, "wedge.stl")
    content = (tmp_path / "wedge.stl").read_bytes()
    changed = content[:change] if change < 0 else content + bytes(change)
    with pytest.raises(ConfigError, match=r"tells of 8 triangles, 484 bytes, and has"):
        sides_of(tmp_path, "cut.stl", changed)
    named = b"solid like a text".ljust(80) + content[80:]
    assert sides_of(tmp_path, "named.stl", named) == [90.0, 40.0, 70.0]
