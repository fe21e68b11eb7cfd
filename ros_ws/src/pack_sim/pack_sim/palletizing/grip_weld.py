"""A grip as a weld of MuJoCo: made at the pose that the box has, measured, undone."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.errors import PackError
from pack_core.palletizing.grip import GripLoad
from pack_core.palletizing.model import body_pose
from pack_core.robots.surface_gripper import PAD_BIT, TOOL
from pack_core.rotations import Array

ROWS = 6
"""Of a weld among the constraints; it is the only equality that is ever active, and they come first."""


def attach(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> None:
    """Hold the box where it is relative to the tool; needs up-to-date kinematics.

    The pad touches it no more: a pad that is pressed against a box would otherwise load its own grip.
    """
    X_TB = body_pose(data, TOOL).inverse() @ body_pose(data, box)
    weld = model.equality(box).id
    model.eq_data[weld, 0:3] = 0.0
    model.eq_data[weld, 3:6], model.eq_data[weld, 6:10] = X_TB.p, X_TB.q
    data.eq_active[weld] = 1
    model.geom_conaffinity[model.geom(box).id] &= ~PAD_BIT


def is_awake(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> bool:
    """Whether the box takes part in the physics now; if not, it does from the next step on.

    A box that is woken by its own weld would miss its support for one step.
    """
    body = model.body(box)
    if data.tree_asleep[model.body_treeid[body.id]] < 0:
        return True
    data.qvel[body.dofadr[0]] = -0.0  # wakes it and changes nothing else, as MuJoCo documents
    return False


def detach(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> None:
    """Let the box go; one that hung still is about to move, whatever its speed was."""
    data.eq_active[model.equality(box).id] = 0
    data.tree_asleep[model.body_treeid[model.body(box).id]] = -(1 + mujoco.mjMINAWAKE)
    model.geom_conaffinity[model.geom(box).id] |= PAD_BIT


def measure(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> GripLoad:
    """What the grip exerted on the box in the last step.

    Raises:
        PackError: the constraints are not those of one grip.
    """
    if data.ne != ROWS:
        raise PackError(f"the model has {data.ne} rows of equality constraints; allowed: {ROWS}, one grip")
    dof = model.body(box).dofadr[0]
    J = data.efc_J.reshape(data.nefc, model.nv)[:ROWS, dof : dof + 6]
    load = J.T @ data.efc_force[:ROWS]
    body, tool = data.body(box), data.body(TOOL)
    R_WT = tool.xmat.reshape(3, 3)
    force = load[:3]
    # a free joint has its torque in the frame of the body, about its origin
    torque = body.xmat.reshape(3, 3) @ load[3:] - _cross(tool.xpos - body.xpos, force)
    f_T = R_WT.T @ force
    return GripLoad(-float(f_T[2]), float(np.hypot(f_T[0], f_T[1])), float(np.linalg.norm(torque)))


def _cross(a: Array, b: Array) -> Array:
    """Cross product of two `(3,)`; numpy's takes ten times as long, and this is asked in every step."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
