"""Boxes around the fingers of a gripper, which move with its opening."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import mujoco
import numpy as np

from pack_core.rotations import Array
from pack_motion.arm.body_boxes import BodyBoxes

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
