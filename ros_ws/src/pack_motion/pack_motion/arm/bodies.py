"""Boxes around the colliding shapes of an arm and of its gripper's fingers, taken from its MuJoCo model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


@dataclass(frozen=True)
class BodyBoxes:
    """Boxes fixed to links, with their poses where all joints are zero.

    Attributes:
        names: name of each box.
        link: index of the joint that moves each box `(k,)`; -1 where none does.
        R: orientation of each box in the world `(k, 3, 3)`.
        p: centre of each box in the world `(k, 3)` [m].
        half: half edge lengths of each box `(k, 3)` [m].
    """

    names: tuple[str, ...]
    link: npt.NDArray[np.int64]
    R: Array
    p: Array
    half: Array

    def __len__(self) -> int:
        return len(self.names)

    def moved(self, R_links: Array, d_links: Array) -> tuple[Array, Array]:
        """Orientations `(k, 3, 3)` and centres `(k, 3)` [m] for link displacements from the zero posture."""
        R, d = R_links[self.link], d_links[self.link]
        return R @ self.R, np.einsum("kij,kj->ki", R, self.p) + d

    def joined(self, other: BodyBoxes) -> BodyBoxes:
        """These boxes, followed by the other ones."""
        return BodyBoxes(
            (*self.names, *other.names), np.concatenate([self.link, other.link]),
            np.concatenate([self.R, other.R]), np.concatenate([self.p, other.p]),
            np.concatenate([self.half, other.half]),
        )  # fmt: skip


def boxes_from_model(
    model: mujoco.MjModel, joints: Sequence[str], *, without: Sequence[str] = ()
) -> BodyBoxes:
    """The boxes around every shape of the model that can touch something and moves with a joint.

    Args:
        model: the model of the arm.
        joints: names of the arm's joints, from the base on.
        without: names of bodies that are left out.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, data)
    carried_by = {int(model.joint(name).bodyid[0]): i for i, name in enumerate(joints)}
    names, links, R, p, half = [], [], [], [], []
    for geom in range(model.ngeom):
        body = model.body(model.geom_bodyid[geom]).name
        link = _link_of(model, int(model.geom_bodyid[geom]), carried_by)
        touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if link is None or not touches or body in without:
            continue
        centre, size = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        orientation = data.geom_xmat[geom].reshape(3, 3)
        names.append(model.geom(geom).name or body)
        links.append(link)
        R.append(orientation.copy())
        p.append(data.geom_xpos[geom] + orientation @ centre)
        half.append(size.copy())
    return BodyBoxes(tuple(names), np.array(links, dtype=np.int64), np.array(R), np.array(p), np.array(half))


def fixed_boxes(model: mujoco.MjModel, body: str) -> BodyBoxes:
    """The boxes around every shape of a body that no joint moves."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    first, count = int(model.body(body).geomadr[0]), int(model.body(body).geomnum[0])
    rows = range(first, first + count)
    R = np.array([data.geom_xmat[row].reshape(3, 3) for row in rows])
    p = np.array([data.geom_xpos[row] + R[i] @ model.geom_aabb[row, :3] for i, row in enumerate(rows)])
    half = np.array([model.geom_aabb[row, 3:] for row in rows])
    return BodyBoxes((body,) * count, np.full(count, -1, dtype=np.int64), R, p, half)


def _link_of(model: mujoco.MjModel, body: int, carried_by: dict[int, int]) -> int | None:
    while body != 0:
        if body in carried_by:
            return carried_by[body]
        body = int(model.body_parentid[body])
    return None


SLICE = 0.002
"""Height of the boxes that a sloping finger is cut into [m]; a single box would be too thick at the tip."""


@dataclass(frozen=True)
class Fingers:
    """Boxes around fingers that slide on the last link.

    Attributes:
        closed: the boxes with the fingers closed.
        ways: displacement of each box per metre of opening `(k, 3)`, in the world where all joints are zero.
    """

    closed: BodyBoxes
    ways: Array

    def at(self, opening: float) -> BodyBoxes:
        """The boxes with the fingers `opening` [m] apart."""
        return replace(self.closed, p=self.closed.p + opening * self.ways)


def fingers_from_model(model: mujoco.MjModel, last_link: int, joints: Sequence[str]) -> Fingers:
    """The fingers on sliding joints, each of which is half the opening away from the middle.

    Args:
        model: the model of the arm and its gripper.
        last_link: index of the link that carries the fingers.
        joints: names of the fingers' joints.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, data)
    names, R, p, half, ways = [], [], [], [], []
    for name in joints:
        body = int(model.joint(name).bodyid[0])
        R_WB = data.xmat[body].reshape(3, 3)
        axis = R_WB @ model.jnt_axis[model.joint(name).id]
        for lower, upper in _boxes_of(model, data, body):
            names.append(model.body(body).name)
            R.append(R_WB.copy())
            p.append(data.xpos[body] + R_WB @ (0.5 * (lower + upper)))
            half.append(0.5 * (upper - lower))
            ways.append(0.5 * axis)
    link = np.full(len(names), last_link, dtype=np.int64)
    return Fingers(BodyBoxes(tuple(names), link, np.array(R), np.array(p), np.array(half)), np.array(ways))


def _boxes_of(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> list[tuple[Array, Array]]:
    """Lower and upper corners, in the finger's frame, of boxes that cover its shapes."""
    boxes: list[tuple[Array, Array]] = []
    R_BW = data.xmat[body].reshape(3, 3).T
    for geom in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        corners_W = data.geom_xpos[geom] + _corners(model, geom) @ data.geom_xmat[geom].reshape(3, 3).T
        corners = (corners_W - data.xpos[body]) @ R_BW.T
        is_mesh = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH
        boxes += _slices(corners) if is_mesh else [(corners.min(axis=0), corners.max(axis=0))]
    return boxes


def _corners(model: mujoco.MjModel, geom: int) -> Array:
    """Corners of a shape in its own frame `(n, 3)`: the vertices of a mesh, else of the box around it."""
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        first = model.mesh_vertadr[mesh]
        return np.array(model.mesh_vert[first : first + model.mesh_vertnum[mesh]], dtype=float)
    centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
    return np.asarray(centre + half * (2.0 * np.indices((2, 2, 2)).reshape(3, -1).T - 1.0))


def _slices(corners: Array) -> list[tuple[Array, Array]]:
    """Boxes around slices of the convex hull of corners `(n, 3)`, stacked along z."""
    low, high = corners[:, 2].min(), corners[:, 2].max()
    cuts = np.linspace(low, high, int(np.ceil((high - low) / SLICE - 1e-9)) + 1)
    boxes = []
    for bottom, top in pairwise(cuts):
        inside = corners[(corners[:, 2] >= bottom - 1e-9) & (corners[:, 2] <= top + 1e-9)]
        points = np.vstack([inside, _cut(corners, bottom), _cut(corners, top)])
        boxes.append((points.min(axis=0), points.max(axis=0)))
    return boxes


def _cut(corners: Array, z: float) -> Array:
    """Points at a height `z` on the lines between any two corners `(n, 3)`.

    All these lines lie in the convex hull and its edges are among them, so that the points span the cut.
    """
    points = [
        a + (z - a[2]) / (b[2] - a[2]) * (b - a)
        for a, b in combinations(corners, 2)
        if min(a[2], b[2]) < z < max(a[2], b[2])
    ]
    return np.array(points).reshape(-1, 3)
