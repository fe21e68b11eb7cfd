"""The simulated surface gripper: grips a face in front of its pad, and loses it when overloaded.

Rays from the points that a seal must cover find the box. The grip is a weld constraint of MuJoCo, made at the
box's present pose, measured, and released.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from pack_core.bodies import body_pose
from pack_core.errors import PackError
from pack_core.palletizing.grip import ASKED, GripLimits, GripLoad, GripState
from pack_core.robots.surface_gripper import PAD_BIT, TOOL, GripperTool, Seal
from pack_core.rotations import Array

BEHIND = 0.01
"""How far behind the pad's face the rays start, so that a face that is pressed into it is found [m]."""


@dataclass(frozen=True)
class FaceAhead:
    """The box that can be held and the seal that holds it; or no box, no seal, and the reason."""

    box: str
    seal: Seal | None
    reason: str


def face_ahead(
    model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str], seals: Sequence[Seal], reach: float
) -> FaceAhead:
    """Find the first seal whose points all meet the face of one box within `reach` [m].

    The body poses in `data` must be up to date. Seals are ordered from the largest to the smallest, so that
    the reason given when none fits is that of the smallest.
    """
    reason = ""
    for seal in seals:
        box, reason = _covering(model, data, boxes, seal, reach)
        if box:
            return FaceAhead(box, seal, "")
    return FaceAhead("", None, reason)


def _covering(
    model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str], seal: Seal, reach: float
) -> tuple[str, str]:
    """The name of the box whose face covers a seal, and ""; or "" and the reason why there is none."""
    tool = data.body(TOOL)
    R_WT = tool.xmat.reshape(3, 3)
    starts = tool.xpos + (seal.points - [0.0, 0.0, BEHIND]) @ R_WT.T
    hits = [_hit(model, data, start, R_WT[:, 2], tool.id, reach + BEHIND) for start in starts]
    found = {hit for hit in hits if hit in boxes}
    if len(found) == 1 and len(set(hits)) == 1:
        return found.pop(), ""
    if not found:
        return "", f"no box within {1000 * reach:.0f} mm of the pad"
    if len(found) > 1:
        return "", f"the pad lies across {' and '.join(sorted(found))}"
    return "", f"the pad reaches beyond the face of {found.pop()}, or is tilted against it"


def _hit(
    model: mujoco.MjModel, data: mujoco.MjData, start: Array, axis: Array, tool: int, reach: float
) -> str:
    """Name of the body that a ray meets within `reach` [m]; empty when it meets none."""
    geom = np.zeros(1, dtype=np.int32)
    distance = mujoco.mj_ray(model, data, start, axis, None, True, tool, geom)  # -1 when nothing is met
    if distance < 0.0 or distance > reach:
        return ""
    return str(model.body(model.geom_bodyid[geom[0]]).name)


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


class SurfaceGripper:
    """Takes commands at any time, and carries them out in `update`, after each step of the physics.

    Args:
        tool: the gripper, for its seals.
        limits: when it takes hold and lets go.
    """

    def __init__(self, tool: GripperTool, limits: GripLimits) -> None:
        self._seals, self._limits = tool.seals(), limits
        self._seal = self._seals[0]
        self._deadline: float | None = None
        self._next_try = 0.0
        self._steps_over = 0
        self._is_opening, self._failure, self._has_slipped = False, "", False
        self.state = GripState(reason=ASKED)

    @property
    def is_closed(self) -> bool:
        """Whether it holds a box."""
        return self.state.is_closed

    @property
    def is_open(self) -> bool:
        """Whether it neither holds a box nor tries to."""
        return self.state.is_open

    def close(self) -> None:
        """Grip what is in front of the pad, as soon as there is a box; fails after `retry_time`."""
        self._is_opening = False
        if not self.state.is_closed:
            self._deadline = None
            self.state = GripState(is_closing=True)

    def open(self) -> None:
        """Release the box, or stop trying to grip one."""
        self._is_opening = True

    def fail(self, reason: str) -> None:
        """Have the vacuum break down after the next step, for a reason in words."""
        self._failure = reason

    def slip(self) -> None:
        """Lose the box after the next step without noticing it, as with a vacuum sensor that is stuck.

        Does nothing if no box is held.
        """
        self._has_slipped = self.state.is_closed

    def update(self, model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str]) -> None:
        """Carry out the last command after a step, with the positions and forces of that step."""
        if self._is_opening:
            self._is_opening = False
            self.let_go(model, data, ASKED)
        elif self._failure:
            self.let_go(model, data, self._failure)
            self._failure = ""
        elif self.state.is_closing:
            self._seek(model, data, boxes)
        elif self._has_slipped:
            detach(model, data, self.state.held)
        elif self.state.is_closed:
            self._watch(model, data)

    def let_go(self, model: mujoco.MjModel, data: mujoco.MjData, reason: str) -> None:
        """Lose the box at once, or give up a try to grip one, for a reason in words."""
        if self.state.is_open:
            return
        if self.state.is_closed:
            detach(model, data, self.state.held)
        self._has_slipped = False
        self.state = GripState(peak=self.state.peak, reason=reason)

    def _seek(self, model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str]) -> None:
        if self._deadline is None:
            self._deadline, self._next_try = data.time + self._limits.retry_time, data.time
        if data.time < self._next_try:
            return
        mujoco.mj_kinematics(model, data)
        found = face_ahead(model, data, boxes, self._seals, self._limits.max_grip_distance)
        if found.seal is None:
            self._next_try = data.time + self._limits.retry_interval
            if self._next_try > self._deadline:  # there will be no further try
                self.state = GripState(reason=found.reason)
        elif is_awake(model, data, found.box):  # a sleeping box is woken now and gripped in the next step
            attach(model, data, found.box)
            self._seal, self._steps_over = found.seal, 0
            self.state = GripState(held=found.box)

    def _watch(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        load = measure(model, data, self.state.held)
        self.state = replace(self.state, load=load, peak=self.state.peak.worst(load))
        reason = self._excess(load)
        self._steps_over = self._steps_over + 1 if reason else 0
        if self._steps_over >= self._limits.tolerated_steps:
            self.let_go(model, data, reason)

    def _excess(self, load: GripLoad) -> str:
        """The first limit that the load exceeds, in words; empty where it exceeds none."""
        for passed in self._limits.passed_by(load, self._seal.share):
            return f"{passed.what} {passed.load:.1f} {passed.unit} above {passed.allowed:.1f} {passed.unit}"
        return ""
