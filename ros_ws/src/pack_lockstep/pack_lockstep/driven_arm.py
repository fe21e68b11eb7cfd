"""The motion controller and the driver that it sends setpoints to, stepped together on simulated time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import JointSample, Setpoints
from pack_core.rotations import Array
from pack_motion.controller import MotionController
from pack_motion.reference.trajectory import JointState


class SteppedPhysics(Protocol):
    """What is asked of a simulator's configuration."""

    @property
    def timestep(self) -> float:
        """Time step of the physics [s]."""


class ReferenceDriver(Protocol):
    """What is asked of a simulator that takes joint references."""

    @property
    def config(self) -> SteppedPhysics:
        """Its parameters."""

    @property
    def time(self) -> float:
        """Simulated time [s]."""

    def joints(self) -> JointSample:
        """The arm's measured joints."""

    def accept(self, setpoints: Setpoints) -> None:
        """Take setpoints; MessageError if they are refused."""

    def step(self) -> None:
        """One time step of the physics."""


class DrivenArm:
    """Steps a motion controller and the physics together.

    Args:
        motion: makes a setpoint for each period.
        simulator: carries setpoints out.
        q: joint positions `(n,)` [rad] at the start, where the arm is at rest.
        period: between two setpoints [s].
        on_refusal: called with the reason when the simulator refuses setpoints.

    Attributes:
        sample: the joints as the motion has measured them last; None before the first step.
    """

    def __init__(
        self,
        motion: MotionController,
        simulator: ReferenceDriver,
        q: Array,
        period: float,
        on_refusal: Callable[[str], None],
    ) -> None:
        self._motion, self._simulator, self._period = motion, simulator, period
        self._setpoint = JointState.at_rest(q)
        self._on_refusal = on_refusal
        self.sample: JointSample | None = None

    @property
    def q_des(self) -> Array:
        """Joint positions `(n,)` [rad] of the last setpoint."""
        return self._setpoint.q

    def advance(self) -> None:
        """Make one step of the motion controller, and the physics steps of the same period."""
        simulator, period, last = self._simulator, self._period, self._setpoint
        self.sample = simulator.joints()
        new = self._motion.step(simulator.time + period, self.sample)
        q, v, a = (np.stack(pair) for pair in ((last.q, new.q), (last.v, new.v), (last.a, new.a)))
        try:
            simulator.accept(Setpoints(simulator.time, np.array([0.0, period]), q, v, a=a))
        except MessageError as error:
            self._on_refusal(f"the driver refused setpoints: {error}")
        for _ in range(round(period / simulator.config.timestep)):
            simulator.step()
        self._setpoint = new
