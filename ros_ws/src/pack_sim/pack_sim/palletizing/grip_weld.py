"""A grip as a weld constraint of MuJoCo: made at the box's present pose, measured, and released."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.bodies import body_pose
from pack_core.errors import PackError
from pack_core.palletizing.grip import GripLoad
from pack_core.robots.surface_gripper import PAD_BIT, TOOL
from pack_core.rotations import Array

ROWS = 6
"""Constraint rows of a weld. They are the first: equalities precede contacts, and no other is ever active."""


def attach(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> None:
    """Hold the box at its present pose relative to the tool; body poses in `data` must be up to date.

    Contacts between pad and box are switched off: a pad pressed against the box would load its own grip.
    """
    X_TB = body_pose(data, TOOL).inverse() @ body_pose(data, box)
    weld = model.equality(box).id
    # A weld's eq_data: anchor point in the box (0:3), position (3:6) and orientation (6:10) in the tool.
    model.eq_data[weld, 0:3] = 0.0
    model.eq_data[weld, 3:6], model.eq_data[weld, 6:10] = X_TB.p, X_TB.q
    data.eq_active[weld] = 1
    model.geom_conaffinity[model.geom(box).id] &= ~PAD_BIT


def is_awake(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> bool:
    """Whether the box takes part in the physics now; a sleeping box is woken and does from the next step on.

    It must be awake before it is welded: a box woken by its own weld would miss its support for one step.
    """
    body = model.body(box)
    if data.tree_asleep[model.body_treeid[body.id]] < 0:
        return True
    data.qvel[body.dofadr[0]] = -0.0  # wakes it and changes nothing else, as MuJoCo documents
    return False


def detach(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> None:
    """Release the box, and keep it awake: one that hung still is about to fall, though its speed is zero."""
    data.eq_active[model.equality(box).id] = 0
    # MuJoCo's counter of an awake tree: -(1 + mjMINAWAKE) is fully awake.
    data.tree_asleep[model.body_treeid[model.body(box).id]] = -(1 + mujoco.mjMINAWAKE)
    model.geom_conaffinity[model.geom(box).id] |= PAD_BIT


def measure(model: mujoco.MjModel, data: mujoco.MjData, box: str) -> GripLoad:
    """The load of the grip in the last step: the weld's generalised force on the box, in the tool's frame.

    Raises:
        PackError: the constraints are not those of one grip.
    """
    if data.ne != ROWS:
        raise PackError(f"the model has {data.ne} rows of equality constraints; allowed: {ROWS}, one grip")
    dof = model.body(box).dofadr[0]
    J = data.efc_J.reshape(data.nefc, model.nv)[:ROWS, dof : dof + 6]
    load = J.T @ data.efc_force[:ROWS]  # J^T f: force and torque of the weld on the box's free joint
    body, tool = data.body(box), data.body(TOOL)
    R_WT = tool.xmat.reshape(3, 3)
    force = load[:3]
    # A free joint has its torque in the body's frame, about the body's origin: it is turned into the world
    # and moved to the middle of the pad's face.
    torque = body.xmat.reshape(3, 3) @ load[3:] - _cross(tool.xpos - body.xpos, force)
    f_T = R_WT.T @ force
    return GripLoad(-float(f_T[2]), float(np.hypot(f_T[0], f_T[1])), float(np.linalg.norm(torque)))


def _cross(a: Array, b: Array) -> Array:
    """Cross product of two vectors `(3,)`; numpy's takes ten times as long, and this runs in every step."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
