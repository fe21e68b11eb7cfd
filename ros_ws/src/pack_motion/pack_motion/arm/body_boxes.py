"""Boxes around the colliding shapes of an arm, taken from its MuJoCo model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
