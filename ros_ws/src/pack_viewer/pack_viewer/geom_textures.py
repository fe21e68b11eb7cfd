"""Pictures on MuJoCo's geoms: which picture, and where on the surface."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import trimesh
from PIL import Image

from pack_core.rotations import Array

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
