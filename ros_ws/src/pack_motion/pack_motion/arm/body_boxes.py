"""Boxes around the shapes that an arm touches with, read off its model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


@dataclass(frozen=True)
class BodyBoxes:
    """Boxes fixed to links, given where all joints are zero.

    Attributes:
        names: of each box.
        link: index of the joint that moves it `(k,)`.
        R: orientation in the world `(k, 3, 3)`.
        p: centre in the world `(k, 3)` [m].
        half: half edge lengths `(k, 3)` [m].
    """

    names: tuple[str, ...]
    link: npt.NDArray[np.int64]
    R: Array
    p: Array
    half: Array

    def __len__(self) -> int:
        return len(self.names)

    def moved(self, R_links: Array, d_links: Array) -> tuple[Array, Array]:
        """Orientations `(k, 3, 3)` and centres `(k, 3)` with the links displaced so."""
        R, d = R_links[self.link], d_links[self.link]
        return R @ self.R, np.einsum("kij,kj->ki", R, self.p) + d


def boxes_from_model(model: mujoco.MjModel, joints: Sequence[str]) -> BodyBoxes:
    """The boxes around every shape of the model that can touch something and moves with a joint."""
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, data)
    carried_by = {int(model.joint(name).bodyid[0]): i for i, name in enumerate(joints)}
    names, links, R, p, half = [], [], [], [], []
    for geom in range(model.ngeom):
        link = _link_of(model, int(model.geom_bodyid[geom]), carried_by)
        if link is None or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        centre, size = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        orientation = data.geom_xmat[geom].reshape(3, 3)
        names.append(model.geom(geom).name or model.body(model.geom_bodyid[geom]).name)
        links.append(link)
        R.append(orientation.copy())
        p.append(data.geom_xpos[geom] + orientation @ centre)
        half.append(size.copy())
    return BodyBoxes(tuple(names), np.array(links, dtype=np.int64), np.array(R), np.array(p), np.array(half))


def _link_of(model: mujoco.MjModel, body: int, carried_by: dict[int, int]) -> int | None:
    while body != 0:
        if body in carried_by:
            return carried_by[body]
        body = int(model.body_parentid[body])
    return None
