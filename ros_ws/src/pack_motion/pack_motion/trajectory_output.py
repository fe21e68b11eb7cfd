"""Tells a driver that takes whole trajectories what a stream of setpoints tells one that takes setpoints."""

from __future__ import annotations

from enum import Enum, auto

import numpy as np

from pack_core.joints import JointSample, Setpoints
from pack_motion.controller import SHORT
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import ReferenceTrajectory
from pack_motion.setpoint_stream import SetpointStream

THINNING = 5
"""Every fifth of a plan's rows, 4 ms apart, is sent: quintics between them are within 0.02 mrad of it."""
SAME_POSITION, SAME_SPEED = 2e-4, 0.01
"""What was sent still holds where it is as near as this to what is wanted now [rad, rad/s]."""
LONGEST_GAP = 1.0
"""In the joint states, for which the driver is taken to go on along what it was sent [s]."""


class Cancel(Enum):
    """Tells a driver to give up what it was sent, and to hold the arm where it is."""

    CANCEL = auto()


class TrajectoryOutput:
    """Makes trajectories of a stream of setpoints, each to replace the one before while the arm moves.

    A trajectory begins with the setpoints up to the horizon, which never change once they are given out. It
    goes on with the controller's outlook: with the rest of the move, so that one trajectory does for a whole
    move that nothing disturbs. While the arm gives way it is a stop instead, and is replaced before that
    begins. So each ends at rest, and the driver goes on smoothly from one to the next if a trajectory is with
    it within the horizon.

    Args:
        stream: of setpoints.
        horizon: of the stream's setpoints beyond the measurement [s].
    """

    def __init__(self, stream: SetpointStream, horizon: float) -> None:
        self._stream, self._wait = stream, 0.5 * horizon
        self._sent: Setpoints | None = None
        self._plan: MotionPlan = stream.controller.plan
        self._time = -np.inf

    def advance(self, sample: JointSample, *, is_stopped: bool) -> Setpoints | Cancel | None:
        """Step the stream; what the driver is to be told after a measurement, None where nothing is new.

        Args:
            sample: the measurement, at the driver's time.
            is_stopped: whether the driver refuses to move, after an emergency stop for instance.
        """
        reference, controller = self._stream.advance(sample), self._stream.controller
        if is_stopped or (controller.is_held and self._stream.is_astray):
            return self._forget()
        if reference is None:
            return self._bring_to_rest()
        is_new = controller.plan is not self._plan and controller.plan.trajectory.duration > SHORT
        if is_new or (sample.time - self._time >= self._wait and self._differs()):
            return self._tell(reference)
        return None

    def _forget(self) -> Cancel | None:
        self._plan = self._stream.controller.plan
        if self._sent is None:
            return None
        self._sent = None
        return Cancel.CANCEL

    def _bring_to_rest(self) -> Setpoints | None:
        """The stop from the last setpoint that was given out, once."""
        if self._sent is None or not self._differs_from_a_stop():
            return None
        return self._tell(self._stream.given)

    def _tell(self, reference: Setpoints) -> Setpoints:
        controller = self._stream.controller
        self._plan, self._time = controller.plan, reference.time
        self._sent = continued(reference, controller.outlook())
        return self._sent

    def _differs(self) -> bool:
        """Whether the last setpoint is not the one that the driver knows."""
        told, time = self._stream.controller.commanded, self._stream.controller.time
        if self._sent is None:
            return not told.is_at_rest
        q, v, _ = self._sent.at(time)
        return bool(np.abs(q - told.q).max() > SAME_POSITION or np.abs(v - told.v).max() > SAME_SPEED)

    def _differs_from_a_stop(self) -> bool:
        """Whether the driver knows of more than a stop from the last setpoint."""
        assert self._sent is not None
        end = self._stream.controller.outlook().end
        return bool(np.abs(self._sent.q[-1] - end.q).max() > SAME_POSITION)


def continued(reference: Setpoints, outlook: ReferenceTrajectory) -> Setpoints:
    """Setpoints, and what follows them from their last row on, in every `THINNING`-th of its rows."""
    last = len(outlook.times) - 1
    kept = sorted({*range(THINNING, last, THINNING), last} - {0})
    assert reference.a is not None
    q, v, a = (
        np.concatenate([first, rows[kept]])
        for first, rows in ((reference.q, outlook.q), (reference.v, outlook.v), (reference.a, outlook.a))
    )
    v[-1] = a[-1] = 0.0
    offsets = np.concatenate([reference.offsets, reference.offsets[-1] + outlook.times[kept]])
    return Setpoints(reference.time, offsets, q, v, a=a)


class DriverClock:
    """Counts trajectory seconds tau: d tau / dt is the driver's scaling factor; without scaling tau is t.

    All that is planned ahead is planned in tau, so that an arm whose driver slows down, or pauses, is where
    it was told to be, only later.
    """

    def __init__(self) -> None:
        self._time: float | None = None
        self._behind, self._factor = 0.0, 1.0

    def at(self, time: float) -> float:
        """Trajectory time at `time` [s]."""
        ahead = 0.0 if self._time is None else max(time - self._time, 0.0)
        return time - self._behind - (1.0 - self._factor) * ahead

    def stamp(self, tau: float) -> float:
        """Stamp of a trajectory whose first row is due at `tau` [s], as a driver reads stamps."""
        now = self._time or 0.0
        return tau + now - self.at(now)

    def see(self, time: float, factor: float) -> None:
        """Note the scaling factor that the driver reports for its cycle at `time` [s]."""
        if self._time is not None and time > self._time:
            # A factor holds from its cycle to the next one.
            self._behind += (1.0 - self._factor) * (time - self._time)
        self._time, self._factor = time, factor

    def restart(self) -> None:
        """Begin anew, as after a reset of the simulator."""
        self._time, self._behind, self._factor = None, 0.0, 1.0
