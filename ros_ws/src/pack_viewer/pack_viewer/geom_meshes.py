"""MuJoCo's geoms as coloured and textured meshes, in the format that a browser draws (GLB)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import mujoco
import numpy as np
import trimesh
from PIL import Image
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from pack_core.rotations import Array, to_matrix

LARGEST_TEXTURE = 512
"""Pixels along a texture's longer edge."""
FACES = ((0, 1, (1, 2)), (0, -1, (1, 2)), (1, 1, (0, 2)), (1, -1, (0, 2)), (2, 1, (0, 1)), (2, -1, (0, 1)))
"""Faces of a box in the order of MuJoCo's cube textures: normal axis, its sign, and the two other axes."""


def texture_of(
    model: mujoco.MjModel, material: int, kind: mujoco.mjtGeom, mesh: trimesh.Trimesh
) -> tuple[Image.Image | None, Any]:
    """What a surface looks like.

    Args:
        model: has the material.
        material: its number; -1 for none.
        kind: type of the geom.
        mesh: surface of the geom.

    Returns:
        The picture and the texture coordinates `(V, 2)`; None and None where the surface is plain.
    """
    texture = model.mat_texid[material, mujoco.mjtTextureRole.mjTEXROLE_RGB] if material >= 0 else -1
    if texture < 0 or kind not in (mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_PLANE):
        return None, None
    picture = _picture(model, texture)
    if model.tex_type[texture] == mujoco.mjtTexture.mjTEXTURE_CUBE and kind == mujoco.mjtGeom.mjGEOM_BOX:
        return picture, _cube_uv(six=picture.height > picture.width)
    repeat = model.mat_texrepeat[material]
    flat = _flat_uv(mesh)
    if not model.mat_texuniform[material]:  # so many times over the whole geom instead of a metre
        flat = flat / np.maximum(np.ptp(flat, axis=0), 1e-9)
    return picture, flat * repeat


def _picture(model: mujoco.MjModel, texture: int) -> Image.Image:
    height, width = int(model.tex_height[texture]), int(model.tex_width[texture])
    channels, first = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
    pixels = model.tex_data[first : first + height * width * channels].reshape(height, width, channels)
    picture = Image.fromarray(np.ascontiguousarray(pixels[..., :3]))
    scale = LARGEST_TEXTURE / max(width, height // 6 if height == 6 * width else height)
    return picture if scale >= 1.0 else picture.resize((round(width * scale), round(height * scale)))


def _cube_uv(*, six: bool) -> Array:
    """Texture coordinates `(24, 2)` of a box: six pictures in a column, or the same one on every face."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    if not six:
        return np.tile(corners, (6, 1))
    # glTF's v, as trimesh takes it, runs upwards, and the column's first picture is at its top.
    rows = [corners * [1.0, 1.0 / 6.0] + [0.0, (5 - face) / 6.0] for face in range(6)]
    return np.concatenate(rows)


def _flat_uv(mesh: trimesh.Trimesh) -> Array:
    """Texture coordinates `(V, 2)` [m]: every face as seen along its normal."""
    if len(mesh.vertices) == 4:
        return np.asarray(mesh.vertices[:, :2])
    axes = [(u, v) for _, _, (u, v) in FACES for _ in range(4)]
    return np.array([[vertex[u], vertex[v]] for vertex, (u, v) in zip(mesh.vertices, axes, strict=True)])


Colour = tuple[float, ...]
"""Red, green, blue and opacity, from 0 to 1."""
SECTIONS = 32
"""Flat faces around a cylinder."""
UNBOUNDED = 5.0
"""Half the size of a plane that MuJoCo draws without end [m]."""
ROUGH = 0.8
"""Roughness of every surface, from 0 (a mirror) to 1."""
HIDDEN_GROUP = 3
"""MuJoCo's group of geoms that only collide."""


def visible_geoms(model: mujoco.MjModel, body: int) -> list[int]:
    """The geoms of a body that are drawn, by number."""
    first = model.body_geomadr[body]
    return [
        geom
        for geom in range(first, first + model.body_geomnum[body])
        if model.geom_group[geom] != HIDDEN_GROUP and _rgba(model, geom)[3] > 0.0
    ]


def body_glb(model: mujoco.MjModel, geoms: Iterable[int], *, rgba: Colour | None = None) -> bytes:
    """Geoms of one body as one GLB file, in the body's frame.

    Args:
        model: the model.
        geoms: numbers of the geoms.
        rgba: one colour for all of them, such as a ghost's; None: as the model has them.
    """
    meshes = [_geom_mesh(model, geom, rgba) for geom in geoms]
    return bytes(trimesh.Scene(meshes).export(file_type="glb", include_normals=True))


def box_glb(model: mujoco.MjModel, half: Array, *, material: str = "", rgba: Colour | None = None) -> bytes:
    """A box as a GLB file, its origin in its middle.

    Args:
        model: has the material.
        half: half its edge lengths `(3,)` [m].
        material: what it looks like.
        rgba: a plain colour instead.
    """
    mesh = _box(np.asarray(half))
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_MATERIAL, material)
    _dress(
        model,
        mesh,
        mujoco.mjtGeom.mjGEOM_BOX,
        number,
        rgba or (1.0, 1.0, 1.0, 1.0),
        is_plain=rgba is not None,
    )
    return bytes(trimesh.Scene([mesh]).export(file_type="glb", include_normals=True))


def _geom_mesh(model: mujoco.MjModel, geom: int, rgba: Colour | None) -> trimesh.Trimesh:
    kind = mujoco.mjtGeom(model.geom_type[geom])
    mesh = _hull(model, geom) if kind == mujoco.mjtGeom.mjGEOM_MESH else _shape(kind, model.geom_size[geom])
    colour = rgba or tuple(_rgba(model, geom))
    _dress(model, mesh, kind, int(model.geom_matid[geom]), colour, is_plain=rgba is not None)
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = to_matrix(model.geom_quat[geom]), model.geom_pos[geom]
    return mesh.apply_transform(X)


def _shape(kind: mujoco.mjtGeom, size: Array) -> trimesh.Trimesh:
    """The surface of a geom in its own frame."""
    match kind:
        case mujoco.mjtGeom.mjGEOM_PLANE:
            half = np.where(size[:2] > 0.0, size[:2], UNBOUNDED)
            corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [*half, 1.0]
            return trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)
        case mujoco.mjtGeom.mjGEOM_BOX:
            return _box(size)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return trimesh.creation.icosphere(radius=size[0], subdivisions=2)
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return trimesh.creation.icosphere(subdivisions=2).apply_scale(size)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            mesh = trimesh.creation.capsule(height=2 * size[1], radius=size[0], count=(12, 24))
            return mesh.apply_translation(-mesh.bounds.mean(axis=0))  # MuJoCo's origin is its middle
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            mesh = trimesh.creation.cylinder(radius=size[0], height=2 * size[1], sections=SECTIONS)
            return trimesh.graph.smooth_shade(mesh, angle=np.radians(40.0))
    raise ValueError(f"no surface for a geom of type {kind.name}")


def _dress(
    model: mujoco.MjModel, mesh: trimesh.Trimesh, kind: mujoco.mjtGeom, material: int, rgba: Colour, *,
    is_plain: bool,
) -> None:  # fmt: skip
    """Give a mesh its colour, and the texture of the material with this number unless it is to be plain."""
    picture, uv = (None, None) if is_plain else texture_of(model, material, kind, mesh)
    plain = np.zeros((len(mesh.vertices), 2))
    mesh.visual = TextureVisuals(uv=plain if uv is None else uv, material=_material(rgba, picture))


def _hull(model: mujoco.MjModel, geom: int) -> trimesh.Trimesh:
    """A geom's own mesh, with edges that stay sharp."""
    mesh = int(model.geom_dataid[geom])
    v, f = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
    vertices = model.mesh_vert[v : v + model.mesh_vertnum[mesh]]
    faces = model.mesh_face[f : f + model.mesh_facenum[mesh]]
    surface = trimesh.Trimesh(vertices, faces, process=False)
    return trimesh.graph.smooth_shade(surface, angle=np.radians(30.0))


def _box(half: Array) -> trimesh.Trimesh:
    """A box whose faces share no vertices, so that each has a texture and a normal of its own."""
    vertices: list[Array] = []
    faces: list[list[int]] = []
    for axis, sign, (u, v) in FACES:
        corners = np.zeros((4, 3))
        corners[:, axis] = sign * half[axis]
        corners[:, u] = np.array([-1, 1, 1, -1]) * half[u]
        corners[:, v] = np.array([-1, -1, 1, 1]) * half[v]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        ring = [0, 1, 2, 3] if normal[axis] * sign > 0 else [0, 3, 2, 1]
        first = len(vertices)
        vertices.extend(corners)
        faces += [
            [first + ring[0], first + ring[1], first + ring[2]],
            [first + ring[0], first + ring[2], first + ring[3]],
        ]
    return trimesh.Trimesh(np.array(vertices), faces, process=False)


def _rgba(model: mujoco.MjModel, geom: int) -> Array:
    """A geom's colour, or its material's where the geom has MuJoCo's default grey."""
    material, own = model.geom_matid[geom], model.geom_rgba[geom]
    is_default = np.allclose(own, (0.5, 0.5, 0.5, 1.0))
    colour: Array = model.mat_rgba[material] if material >= 0 and is_default else own
    return colour


def _material(rgba: Colour, picture: Image.Image | None) -> PBRMaterial:
    # MuJoCo shows its colours as they are (sRGB); glTF wants them linear, by about the power of 2.2.
    linear = [float(c) ** 2.2 for c in rgba[:3]]
    return PBRMaterial(
        baseColorFactor=[*linear, float(rgba[3])], baseColorTexture=picture, metallicFactor=0.0,
        roughnessFactor=ROUGH, alphaMode="BLEND" if rgba[3] < 1.0 else "OPAQUE", doubleSided=True,
    )  # fmt: skip
