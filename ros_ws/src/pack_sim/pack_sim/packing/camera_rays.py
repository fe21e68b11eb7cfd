"""What the rays through a camera's pixels meet.

`mj_multiRay` tries each ray of an image by itself, which takes 60 ms for one of 320 x 428 pixels. The rays of
a camera leave the same point, though: every geom has a rectangle in the image outside of which no ray meets
it. With these, and meshes face by face, it takes 5 ms (docs/journal/2026-11-30_rays_of_a_camera.md).

A geom is met in its own frame G. There the camera is at o = p_GC, and the ray of a pixel leaves along a, its
direction (x, y, 1) in the camera's frame turned by R_GC. So o + t a is t along the optical axis.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numba
import numpy as np
import numpy.typing as npt

from pack_core.camera import PinholeCamera
from pack_core.errors import PackError
from pack_core.rotations import Array, to_matrix

REACH = 2.0
"""Nothing farther away is met [m]."""
NEAREST = 0.01
"""What comes nearer to the camera's plane may be seen anywhere in the image [m]."""
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
"""Of a box with half extents of one."""
PLANE, SPHERE, CAPSULE, CYLINDER, BOX, MESH = (
    int(getattr(mujoco.mjtGeom, f"mjGEOM_{name}"))
    for name in ("PLANE", "SPHERE", "CAPSULE", "CYLINDER", "BOX", "MESH")
)
SHAPES = (PLANE, SPHERE, CAPSULE, CYLINDER, BOX, MESH)
"""What objects, arms and tables are made of."""
Numbers = npt.NDArray[np.int64]
"""Ids, kinds and indices."""
Ray = tuple[float, float, float]
"""A direction in a geom's frame, its part along the optical axis 1."""
Hit = tuple[float, float, float, float]
"""How far along the optical axis a ray meets a geom [m], and x, y and z of the unit normal there."""
MISSED = (np.inf, 0.0, 0.0, 0.0)
"""What a ray has that meets nothing."""


@dataclass(frozen=True)
class RayImage:
    """What the pixels of a camera meet, without errors.

    Attributes:
        depth: along the optical axis `(height, width)` [m]; 0 where a pixel meets nothing.
        cosine: of the angle of incidence `(height, width)`.
        geoms: ids of the geoms that they meet `(height, width)`; -1 for nothing.
    """

    depth: Array
    cosine: Array
    geoms: npt.NDArray[np.int32]


class Pixels(NamedTuple):
    """Directions (x, y, 1) of an image's rays, and what they have met so far.

    Attributes:
        x: by column `(width,)`.
        y: by row `(height,)`.
        lengths: of the directions `(height, width)`.
        depth: `(height, width)` [m]; infinite where nothing has been met yet.
        cosine: `(height, width)`.
        geoms: `(height, width)`.
    """

    x: Array
    y: Array
    lengths: Array
    depth: Array
    cosine: Array
    geoms: npt.NDArray[np.int32]


class Geoms(NamedTuple):
    """The n geoms of a model that are in view, and their frames G as the camera has them.

    Attributes:
        ids: `(n,)`.
        kinds: of `SHAPES` `(n,)`.
        sizes: as the model has them `(n, 3)` [m].
        R_GC: `(n, 3, 3)`.
        o: p_GC `(n, 3)` [m].
        bounds: first column, end of columns, first row, end of rows of each geom's rectangle `(n, 4)`.
        faces: first face and end of the faces of each geom that is a mesh `(n, 2)`.
        corners: of all faces, in their geoms' frames `(m, 3, 3)` [m].
    """

    ids: Numbers
    kinds: Numbers
    sizes: Array
    R_GC: Array
    o: Array
    bounds: Numbers
    faces: Numbers
    corners: Array


class CameraRays:
    """The rays of a camera's pixels, which stay the same as long as it hangs where it does.

    Args:
        camera: the camera, as it truly hangs.
    """

    def __init__(self, camera: PinholeCamera) -> None:
        self._camera, self._X_CW = camera, camera.X_WC.inverse()
        u, v = np.arange(camera.width, dtype=float), np.arange(camera.height, dtype=float)
        self._x, self._y = (u - camera.c[0]) / camera.f, (v - camera.c[1]) / camera.f
        self._lengths = np.sqrt(self._x**2 + self._y[:, None] ** 2 + 1.0)
        self._meshes: tuple[mujoco.MjModel, Numbers, Array] | None = None

    def cast(self, model: mujoco.MjModel, data: mujoco.MjData) -> RayImage:
        """What the rays meet as the physics stands; they pass through what is transparent.

        Raises:
            PackError: a geom in view has a shape that is not in `SHAPES`.
        """
        camera, shape = self._camera, self._lengths.shape
        pixels = Pixels(
            self._x, self._y, self._lengths, np.full(shape, np.inf), np.zeros(shape),
            np.full(shape, -1, dtype=np.int32),
        )  # fmt: skip
        _meet_all(self._in_view(model, data), camera.f, camera.c[0], camera.c[1], pixels)
        depth = np.where(np.isinf(pixels.depth), 0.0, pixels.depth)
        return RayImage(depth, pixels.cosine, pixels.geoms)

    def _in_view(self, model: mujoco.MjModel, data: mujoco.MjData) -> Geoms:
        """The geoms that rays may meet."""
        R_CW = to_matrix(self._X_CW.q)
        R_CG = R_CW @ data.geom_xmat.reshape(-1, 3, 3)
        p_CG = data.geom_xpos @ R_CW.T + self._X_CW.p
        bounds = self._bounds(model, R_CG, p_CG)
        is_in_view = (bounds[:, 0] < bounds[:, 1]) & (bounds[:, 2] < bounds[:, 3])
        ids = np.flatnonzero(is_in_view & _is_drawn(model))
        kinds = model.geom_type[ids].astype(np.int64)
        for geom, kind in zip(ids, kinds, strict=True):
            if kind not in SHAPES:
                known = ", ".join(mujoco.mjtGeom(shape).name for shape in SHAPES)
                raise PackError(
                    f"cameras do not see geom {geom}, a {mujoco.mjtGeom(kind).name}; known: {known}"
                )
        if self._meshes is None or self._meshes[0] is not model:
            self._meshes = model, *_meshes(model)
        _, faces, corners = self._meshes
        R_GC = np.ascontiguousarray(R_CG[ids].transpose(0, 2, 1))
        o = -np.einsum("gij,gj->gi", R_GC, p_CG[ids])
        return Geoms(ids, kinds, model.geom_size[ids], R_GC, o, bounds[ids], faces[ids], corners)

    def _bounds(self, model: mujoco.MjModel, R_CG: Array, p_CG: Array) -> Numbers:
        """Every geom's rectangle in the image `(ngeom, 4)`, as `Geoms` has it."""
        camera = self._camera
        corners_G = model.geom_aabb[:, None, :3] + CORNERS * model.geom_aabb[:, None, 3:]
        corners = corners_G @ R_CG.transpose(0, 2, 1) + p_CG[:, None]
        # A plane has no box, and the image of what is beside or behind the camera has no bounds.
        is_bounded = (corners[..., 2] > NEAREST).all(axis=1) & (model.geom_rbound > 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            uv = camera.f * corners[..., :2] / corners[..., 2:] + camera.c
        size = np.array([camera.width, camera.height])
        first = np.where(is_bounded[:, None], np.floor(uv.min(axis=1)), 0.0)
        end = np.where(is_bounded[:, None], np.ceil(uv.max(axis=1)) + 1.0, size)
        found = np.clip(np.stack([first, end], axis=2), 0, size[:, None])
        return np.asarray(found.reshape(-1, 4), dtype=np.int64)


def _is_drawn(model: mujoco.MjModel) -> npt.NDArray[np.bool_]:
    """Which geoms are not transparent `(ngeom,)`."""
    alpha, has_material = model.geom_rgba[:, 3].copy(), model.geom_matid >= 0
    alpha[has_material] = model.mat_rgba[model.geom_matid[has_material], 3]
    return np.asarray(alpha > 0.0)


def _meshes(model: mujoco.MjModel) -> tuple[Numbers, Array]:
    """First face and end of faces of each geom `(ngeom, 2)`, and the corners of all faces `(m, 3, 3)` [m]."""
    mesh = np.where(model.geom_type == MESH, model.geom_dataid, -1)
    faces = np.zeros((model.ngeom, 2), dtype=np.int64)
    if not model.nmesh:
        return faces, np.zeros((0, 3, 3))
    first = np.where(mesh >= 0, model.mesh_faceadr[mesh], 0)
    faces[:, 0], faces[:, 1] = first, first + np.where(mesh >= 0, model.mesh_facenum[mesh], 0)
    of_face = np.repeat(model.mesh_vertadr, model.mesh_facenum)
    return faces, np.asarray(model.mesh_vert[model.mesh_face + of_face[:, None]], dtype=float)


@numba.njit(nogil=True, cache=True)
def _meet_all(geoms: Geoms, f: float, c_u: float, c_v: float, pixels: Pixels) -> None:
    """Meet one geom after the other; whatever is nearer than all before counts."""
    for n in range(len(geoms.ids)):
        kind, R_GC, o, bounds = geoms.kinds[n], geoms.R_GC[n], geoms.o[n], geoms.bounds[n]
        if kind == MESH:
            corners = geoms.corners[geoms.faces[n, 0] : geoms.faces[n, 1]]
            _meet_faces(geoms.ids[n], corners, R_GC, o, bounds, f, c_u, c_v, pixels)
        else:
            _meet(geoms.ids[n], kind, geoms.sizes[n], R_GC, o, bounds, pixels)


@numba.njit(cache=True)
def _ray(R_GC: Array, x: float, y: float) -> Ray:
    """The direction (x, y, 1) in the geom's frame."""
    return (
        R_GC[0, 0] * x + R_GC[0, 1] * y + R_GC[0, 2],
        R_GC[1, 0] * x + R_GC[1, 1] * y + R_GC[1, 2],
        R_GC[2, 0] * x + R_GC[2, 1] * y + R_GC[2, 2],
    )


@numba.njit(cache=True)
def _dot(a: Array, b: Ray) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@numba.njit(cache=True)
def _note(geom: int, v: int, u: int, t: float, along: float, pixels: Pixels) -> None:
    """Take up that a pixel meets a geom at depth t, unless something nearer is there.

    `along` is the product of the unit normal there and the pixel's direction.
    """
    length = pixels.lengths[v, u]
    if t < pixels.depth[v, u] and t * length <= REACH:
        pixels.depth[v, u], pixels.geoms[v, u] = t, geom
        pixels.cosine[v, u] = -along / length


@numba.njit(cache=True)
def _meet(geom: int, kind: int, size: Array, R_GC: Array, o: Array, bounds: Numbers, pixels: Pixels) -> None:
    """Meet a geom that is no mesh where nothing nearer has been met."""
    first_u, end_u, first_v, end_v = bounds
    for v in range(first_v, end_v):
        for u in range(first_u, end_u):
            a = _ray(R_GC, pixels.x[u], pixels.y[v])
            if kind == BOX:
                hit = _box(size, o, a)
            elif kind == CYLINDER:
                hit = _cylinder(size, o, a)
            elif kind == CAPSULE:
                hit = _capsule(size, o, a)
            elif kind == SPHERE:
                hit = _sphere(size[0], o[0], o[1], o[2], a)
            else:
                hit = _plane(size, o, a)
            _note(geom, v, u, hit[0], hit[1] * a[0] + hit[2] * a[1] + hit[3] * a[2], pixels)


@numba.njit(cache=True)
def _plane(size: Array, o: Array, a: Ray) -> Hit:
    """The plane z = 0 from above, within its half lengths where it has any."""
    if a[2] >= 0.0 or o[2] < 0.0:
        return MISSED
    t = -o[2] / a[2]
    for i in range(2):
        if size[i] > 0.0 and abs(o[i] + t * a[i]) > size[i]:
            return MISSED
    return t, 0.0, 0.0, 1.0


@numba.njit(cache=True)
def _root(a: float, b: float, c: float) -> float:
    """The least t >= 0 with a t^2 + 2 b t + c = 0; infinite if there is none."""
    discriminant = b * b - a * c
    if discriminant < 0.0 or a == 0.0:
        return np.inf
    root = np.sqrt(discriminant)
    near, far = (-b - root) / a, (-b + root) / a
    if near >= 0.0:
        return float(near)
    return float(far) if far >= 0.0 else np.inf


@numba.njit(cache=True)
def _sphere(r: float, x: float, y: float, z: float, a: Ray) -> Hit:
    """A sphere about the origin, seen from x, y, z."""
    square = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
    t = _root(square, a[0] * x + a[1] * y + a[2] * z, x * x + y * y + z * z - r * r)
    if np.isinf(t):
        return MISSED
    return t, (x + t * a[0]) / r, (y + t * a[1]) / r, (z + t * a[2]) / r


@numba.njit(cache=True)
def _side(size: Array, o: Array, a: Ray) -> Hit:
    """The round side of a cylinder along z; `size` is its radius and half length."""
    r, h = size[0], size[1]
    t = _root(a[0] * a[0] + a[1] * a[1], a[0] * o[0] + a[1] * o[1], o[0] * o[0] + o[1] * o[1] - r * r)
    if np.isinf(t) or abs(o[2] + t * a[2]) > h:
        return MISSED
    return t, (o[0] + t * a[0]) / r, (o[1] + t * a[1]) / r, 0.0


@numba.njit(cache=True)
def _cylinder(size: Array, o: Array, a: Ray) -> Hit:
    """A cylinder along z: its side, or the end that faces the camera."""
    hit, up = _side(size, o, a), 1.0 if o[2] > 0.0 else -1.0
    if abs(o[2]) > size[1] and up * a[2] < 0.0:
        t = (up * size[1] - o[2]) / a[2]
        x, y = o[0] + t * a[0], o[1] + t * a[1]
        if t < hit[0] and x * x + y * y <= size[0] * size[0]:
            return t, 0.0, 0.0, up
    return hit


@numba.njit(cache=True)
def _capsule(size: Array, o: Array, a: Ray) -> Hit:
    """A capsule along z: its side, or the outer half of a sphere at either end."""
    nearest = _side(size, o, a)
    for up in (1.0, -1.0):
        middle = up * size[1]
        hit = _sphere(size[0], o[0], o[1], o[2] - middle, a)
        if hit[0] < nearest[0] and up * (o[2] + hit[0] * a[2] - middle) >= 0.0:
            nearest = hit
    return nearest


@numba.njit(cache=True)
def _box(size: Array, o: Array, a: Ray) -> Hit:
    """A box, by where the ray enters the last of three slabs (Kay and Kajiya, 1986); from outside."""
    enters, leaves, axis = -np.inf, np.inf, 0
    for i in range(3):
        if a[i] == 0.0:
            if abs(o[i]) > size[i]:
                return MISSED
            continue
        side = size[i] if a[i] > 0.0 else -size[i]
        near = (-side - o[i]) / a[i]
        if near > enters:
            enters, axis = near, i
        leaves = min(leaves, (side - o[i]) / a[i])
    if enters > leaves or enters < 0.0:
        return MISSED
    towards = -1.0 if a[axis] > 0.0 else 1.0
    return enters, towards * (axis == 0), towards * (axis == 1), towards * (axis == 2)


@numba.njit(cache=True)
def _meet_faces(
    geom: int, faces: Array, R_GC: Array, o: Array, bounds: Numbers, f: float, c_u: float, c_v: float,
    pixels: Pixels,
) -> None:  # fmt: skip
    """Meet those of a closed mesh's faces that are turned to the camera where nothing nearer has been met.

    A ray along a passes a face with corners i, j, k, as seen from o, on the inner side of its edge i j if
    (i x j) a <= 0. Neighbours have the same edge with the other sign, so that no ray gets between them.
    """
    for corners in faces:
        seen = corners - o
        i, j, k = seen[0], seen[1], seen[2]
        normal = np.cross(j - i, k - i)
        length, away = np.sqrt(np.sum(normal**2)), np.sum(normal * i)
        if length == 0.0 or away >= 0.0:
            continue
        first_u, end_u, first_v, end_v = bounds
        in_C = seen @ R_GC
        if in_C[:, 2].min() > NEAREST:
            us, vs = f * in_C[:, 0] / in_C[:, 2] + c_u, f * in_C[:, 1] / in_C[:, 2] + c_v
            first_u, end_u = max(first_u, int(np.floor(us.min()))), min(end_u, int(np.ceil(us.max())) + 1)
            first_v, end_v = max(first_v, int(np.floor(vs.min()))), min(end_v, int(np.ceil(vs.max())) + 1)
        ij, jk, ki = np.cross(i, j), np.cross(j, k), np.cross(k, i)
        for v in range(first_v, end_v):
            for u in range(first_u, end_u):
                a = _ray(R_GC, pixels.x[u], pixels.y[v])
                along = _dot(normal, a)
                if along < 0.0 and _dot(ij, a) <= 0.0 and _dot(jk, a) <= 0.0 and _dot(ki, a) <= 0.0:
                    _note(geom, v, u, away / along, along / length, pixels)
