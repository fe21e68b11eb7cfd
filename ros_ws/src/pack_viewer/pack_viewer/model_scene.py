"""A MuJoCo model in the 3D scene of the page."""

from __future__ import annotations

from urllib.parse import quote

import mujoco
import numpy as np
from viser import GlbHandle, SceneApi

from pack_core.rotations import Array, Pose
from pack_viewer.geom_meshes import body_glb, visible_geoms

STILL = 2e-4
"""A body whose position [m] and orientation (a quaternion's elements) are off what was sent by less is not
sent again: at a metre a pixel is 1 mm wide, and estimates never stand quite still."""


class ModelScene:
    """Draws the bodies of a model, one node of the scene each, and moves those that have moved.

    Args:
        scene: the page's 3D scene.
        model: what is drawn; its bodies' names are the names in the scene.
        root: name in the scene below which they stand.
    """

    def __init__(self, scene: SceneApi, model: mujoco.MjModel, root: str = "/cell") -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self._handles: dict[int, GlbHandle] = {}
        for body in range(model.nbody):
            if geoms := visible_geoms(model, body):
                name = f"{root}/{scene_name(model.body(body).name or str(body))}"
                self._handles[body] = scene.add_glb(name, body_glb(model, geoms))
        self._bodies = np.array(list(self._handles), dtype=int)
        self._sent = np.full((len(self._bodies), 7), np.inf)

    def body(self, name: str) -> GlbHandle:
        """The node of a body; raises KeyError where nothing of it is drawn."""
        return self._handles[self.model.body(name).id]

    def set_joints(self, names: tuple[str, ...], q: Array) -> None:
        """Put hinge or slide joints at `q` `(n,)` [rad or m]."""
        for name, value in zip(names, q, strict=True):
            self.data.joint(name).qpos = value

    def set_body(self, name: str, X_WB: Pose) -> None:
        """Put a free body, whose joint has its name, at X_WB."""
        self.data.joint(name).qpos = [*X_WB.p, *X_WB.q]

    def send(self) -> int:
        """Move what has moved in the browsers; returns the number of bodies that have."""
        mujoco.mj_kinematics(self.model, self.data)
        poses = np.hstack((self.data.xpos[self._bodies], self.data.xquat[self._bodies]))
        moved = np.flatnonzero(np.abs(poses - self._sent).max(axis=1, initial=0.0) > STILL)
        for row in moved:
            handle = self._handles[int(self._bodies[row])]
            handle.position, handle.wxyz = poses[row, :3], poses[row, 3:]
        self._sent[moved] = poses[moved]
        return len(moved)

    def remove(self) -> None:
        """Take everything out of the scene."""
        for handle in self._handles.values():
            handle.remove()
        self._handles = {}


def scene_name(name: str) -> str:
    """A name as a single step of a path in the scene, where `/` separates steps."""
    return quote(name, safe=" .:-_")
