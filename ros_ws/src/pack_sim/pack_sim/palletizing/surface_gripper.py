"""The simulated surface gripper: grips a face in front of its pad, and loses it when overloaded."""

from __future__ import annotations

from dataclasses import replace

import mujoco

from pack_core.palletizing.grip import ASKED, GripLimits, GripLoad, GripState
from pack_core.robots.surface_gripper import GripperTool
from pack_sim.palletizing.grip_weld import attach, detach, is_awake, measure
from pack_sim.palletizing.pad_rays import face_ahead


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
        self._is_opening, self._failure = False, ""
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
        elif self.state.is_closed:
            self._watch(model, data)

    def let_go(self, model: mujoco.MjModel, data: mujoco.MjData, reason: str) -> None:
        """Lose the box at once, or give up a try to grip one, for a reason in words."""
        if self.state.is_open:
            return
        if self.state.is_closed:
            detach(model, data, self.state.held)
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
