"""The stream of setpoints and the driver in lockstep, the driver's stop, and what must hold after one."""

from __future__ import annotations

from typing import Any

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array
from pack_motion.controller import MotionController
from pack_motion.setpoint_stream import SetpointStream, StreamConfig

REST = 1.0
"""The arm stands this long after a stop [s]."""
WATCHED = 0.4
"""An arm that stands is watched for so long: ten times what setpoints last [s]."""
STANDING = 0.01
"""Below this speed a joint stands [rad/s]."""
NEXT = 9001
"""Id of the move after the stop."""
TURN = 0.02
"""Of the last joint in that move, so small that nothing is touched [rad]."""


class StoppableArm:
    """As `DrivenArm`, but wired as the node `motion` and the driver's `ArmBrake` are.

    Attributes:
        sample: the joints as measured last; None before the first period.
        first: setpoints that were accepted first after a release; None before.
    """

    def __init__(self, motion: MotionController, simulator: Any, limits: JointLimits) -> None:
        self._motion, self._simulator, self.limits = motion, simulator, limits
        self._config = StreamConfig()
        self._stream = SetpointStream(motion, self._config, limits.velocity)
        self.is_stopped = False
        self.sample: JointSample | None = None
        self.first: Array | None = None

    @property
    def q_des(self) -> Array:
        """Joint positions `(n,)` [rad] of the last setpoint."""
        return self._motion.commanded.q

    def stop(self, reason: str) -> None:
        """What `/arm/stop` does in the driver, and in `motion` when it hears of it."""
        self.is_stopped = True
        self._simulator.follower.drop()
        self._stream.abandon(f"the arm was stopped: {reason}")

    def release(self) -> None:
        """What `/arm/resume` does."""
        self.is_stopped, self.first = False, None

    def advance(self) -> None:
        """A period: a measurement is answered, and the physics go on."""
        self.sample = sample = self._simulator.joints()
        given = self._stream.advance(sample)
        if given is not None and not self.is_stopped:
            self._simulator.accept(given)
            self.first = given.q[0] if self.first is None else self.first
        for _ in range(round(self._config.period / self._simulator.config.timestep)):
            self._simulator.step()
        if self._stream.left is not None:
            self._motion.command(self._stream.left)

    def watch(self, duration: float) -> Array:
        """Joint positions `(k, n)` and, behind them, velocities of the next `duration` [s]."""
        rows = []
        for _ in range(round(duration / self._config.period)):
            self.advance()
            assert self.sample is not None
            rows.append([*self.sample.q, *self.sample.v])
        return np.array(rows)

    def follow(self, target: MotionTarget) -> Array:
        """As `watch`, of a move up to its end."""
        assert self._motion.command(target).is_accepted
        rows = [self.watch(self._config.period)]
        while self._motion.status().state in (MotionState.MOVING, MotionState.SETTLING):
            rows.append(self.watch(self._config.period))
        return np.concatenate(rows)


def assert_a_stop_is_safe(arm: StoppableArm, motion: MotionController) -> None:
    """The arm comes to rest, stands on when released, and its next move begins where it really is.

    Args:
        arm: was stopped just now.
        motion: of the arm.
    """
    n = len(arm.limits.names)
    rest = arm.watch(REST)[-1]
    assert np.abs(rest[n:]).max() < STANDING
    arm.release()
    released = arm.watch(WATCHED)
    np.testing.assert_allclose(released[:, :n], np.broadcast_to(rest[:n], released[:, :n].shape), atol=1e-3)
    assert motion.status().state is not MotionState.MOVING
    assert arm.first is not None
    np.testing.assert_allclose(arm.first, rest[:n], atol=1e-3)
    goal = released[-1, :n].copy()
    goal[-1] += TURN
    rows = arm.follow(MotionTarget(NEXT, Path((JointMove(goal),)), is_checked=False))
    assert motion.status().state is MotionState.REACHED
    np.testing.assert_allclose(rows[-1, :n], goal, atol=2e-3)
    # Nothing of the move before is left in it: only the joint that it is about moves.
    assert np.abs(rows[:, : n - 1] - released[-1, : n - 1]).max() < 2e-3
    accelerations = np.diff(rows[:, n:], axis=0) / StreamConfig().period
    assert np.all(np.abs(accelerations) < 1.5 * arm.limits.acceleration)
