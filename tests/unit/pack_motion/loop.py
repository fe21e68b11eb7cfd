"""An arm that does what it is told, and what happened to it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.target import Acceptance, MotionState, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose, from_rpy
from pack_motion.arm.arm import MotionArm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set

PERIOD = 0.004
SHARE = motion_set("shipped").limit_share
ENDED = (MotionState.REACHED, MotionState.STUCK)
World = Callable[[float], Iterable[Obstacle]]


def pose(x: float, y: float, z: float, yaw: float = 0.0) -> Pose:
    """The tool looking down."""
    return Pose(np.array([x, y, z]), from_rpy((np.pi, 0.0, yaw)))


@dataclass
class Loop:
    """A kinematic closed loop."""

    arm: MotionArm
    name: str = "shipped"
    time: float = 0.0
    q: list[Array] = field(default_factory=list)
    v: list[Array] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.controller = MotionController(self.arm, motion_set(self.name), self.time, self.arm.home)

    def run(self, target: MotionTarget, world: World | None = None, limit: float = 30.0) -> Acceptance:
        """Until the target is reached, or the arm is stuck."""
        acceptance = self.controller.command(target)
        assert acceptance.is_accepted, acceptance.reason
        end = self.time + limit
        while self.controller.status().state not in ENDED and self.time < end:
            if world is not None:
                self.controller.observe(world(self.time))
            self.step()
        return acceptance

    def step(self) -> None:
        """One period; the joints are where they were told to be."""
        told = self.controller.commanded
        sample = JointSample(self.time, told.q, told.v, np.zeros(len(told.q)))
        self.time += PERIOD
        setpoint = self.controller.step(self.time, sample)
        self.q.append(setpoint.q)
        self.v.append(setpoint.v)
        self.labels.append(self.controller.status().label)

    @property
    def speeds(self) -> Array:
        """Joint speeds as shares of their limits, at most `(n,)`."""
        return np.asarray((np.abs(self.v) / self.arm.limits.velocity).max(axis=0))

    @property
    def accelerations(self) -> Array:
        """Joint accelerations as shares of their limits, at most `(n,)`."""
        changes = np.diff(np.array(self.v), axis=0, prepend=0.0) / PERIOD
        return np.asarray((np.abs(changes) / self.arm.limits.acceleration).max(axis=0))

    @property
    def tool(self) -> Array:
        """Where the tool has been `(T, 3)` [m]."""
        return np.array([self.arm.chain.forward_matrix(q)[1] for q in self.q])
