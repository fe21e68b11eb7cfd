"""Plans one joint reference through all segments of a path."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.errors import PackError
from pack_core.motion.moves import SLOW_SPEED, JointMove, Line, Mode, Path, PoseMove, Segment
from pack_core.robots.joint_properties import step_effort
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.curve import JERK_TIME, curve_segments
from pack_motion.reference.joint_move import MoveLimits, brake, joint_move
from pack_motion.reference.line_run import BranchFollower, line_run
from pack_motion.reference.trajectory import JointState, MoveRefused, ReferenceTrajectory

SLOWING_TRIES, SLOWING_MARGIN = 6, 0.99
"""How often a joint move is planned anew to keep the tool slow, and the share of that speed it aims at."""

KEPT_RUNS = 8
"""References along lines that are kept: a search changes those at one end of a move, not at the other."""


@dataclass(frozen=True)
class MotionPlan:
    """A reference through a path.

    Attributes:
        trajectory: the reference, from the start to rest at the goal.
        segments: segments of the path; each row of the trajectory has the index of one.
        X_WT: pose of the tool at the goal.
    """

    trajectory: ReferenceTrajectory
    segments: tuple[Segment, ...]
    X_WT: Pose


class PathPlanner:
    """Plans references for one arm.

    Args:
        arm: the arm that moves.
        share: of its velocity and acceleration limits that references use; the rest is the tracking's.
    """

    def __init__(self, arm: MotionArm, share: float) -> None:
        self._arm = arm
        limits = arm.limits
        self._limits = MoveLimits(share * limits.velocity, share * limits.acceleration, arm.jerk)
        self._runs: OrderedDict[Hashable, ReferenceTrajectory] = OrderedDict()

    def plan(self, start: JointState, path: Path) -> MotionPlan:
        """The reference from `start` through all segments, to rest at the last one's end.

        Raises:
            MoveRefused: there is no such reference within the arm's reach and limits.
        """
        if not path.segments:
            raise PackError("a path needs at least one segment")
        trajectory = self._segments(start, path.segments, 0)
        self._check(trajectory)
        return MotionPlan(trajectory, path.segments, self._arm.chain.forward(trajectory.end.q))

    def stop(self, start: JointState) -> ReferenceTrajectory:
        """The fastest stop from `start`."""
        return brake(start, self._limits, 0)

    def _segments(self, start: JointState, segments: Sequence[Segment], i: int) -> ReferenceTrajectory:
        """The reference through the segments from the i-th on."""
        if isinstance(segments[i], Line):
            return self._lines_first(start, segments, i)
        refusals: list[str] = []
        for goal in self._goals(start, segments, i):
            try:
                return self._through(start, goal, segments, i)
            except MoveRefused as refusal:
                refusals.append(str(refusal))
        raise MoveRefused(f"'{segments[i].label}': {refusals[0] if refusals else 'the pose is out of reach'}")

    def _lines_first(self, start: JointState, segments: Sequence[Segment], i: int) -> ReferenceTrajectory:
        """The reference from the i-th segment on, which is a line: lines begin at rest, so the arm brakes."""
        if not start.is_at_rest:
            stopped = brake(start, self._limits, i)
            return stopped.followed_by(self._lines_first(stopped.end, segments, i))
        run, j = self._run(start.q, segments, i, 0.0)
        return self._continued(run, segments, j)

    def _through(
        self, start: JointState, q: Array, segments: Sequence[Segment], i: int
    ) -> ReferenceTrajectory:
        """A joint move to `q`, and the reference through all segments after it.

        Without a stop the move ends in the state in which the next segment begins.
        """
        move = segments[i]
        assert not isinstance(move, Line)
        limits = self._limits.scaled(move.speed, move.acceleration)
        end, after = JointState.at_rest(q), None
        if i + 1 < len(segments) and not move.stop:
            follower = segments[i + 1]
            if isinstance(follower, Line):
                after, j = self._run(q, segments, i + 1, follower.entry_speed)
                end = after.start
            else:
                end = self._passing(start, q, segments, i + 1)
        trajectory = joint_move(start, end, limits, i)
        if move.mode is Mode.SLOW:
            trajectory = self._slowed(trajectory, limits, i)
        if after is not None:
            return self._continued(trajectory.followed_by(after), segments, j)
        return self._continued(trajectory, segments, i + 1)

    def _slowed(self, move: ReferenceTrajectory, limits: MoveLimits, i: int) -> ReferenceTrajectory:
        """The joint move with joint velocities low enough to keep the tool below `SLOW_SPEED`.

        Nearly below, where the move ends or begins with that speed. The tool's speed follows the share of
        the joints' only roughly, hence more than one try.
        """
        share = float((np.abs(move.v) / limits.velocity).max())
        for _ in range(SLOWING_TRIES):
            peak = self._peak_tool_speed(move)
            if peak <= SLOW_SPEED:
                break
            share *= SLOWING_MARGIN * SLOW_SPEED / peak
            move = joint_move(move.start, move.end, limits.scaled(share, 1.0), i)
        return move

    def _peak_tool_speed(self, trajectory: ReferenceTrajectory) -> float:
        """Highest speed of the tool [m/s]."""
        jacobians = map(self._arm.chain.jacobian, trajectory.q)
        return max(float(np.linalg.norm(J[:3] @ v)) for J, v in zip(jacobians, trajectory.v, strict=True))

    def _continued(
        self, trajectory: ReferenceTrajectory, segments: Sequence[Segment], j: int
    ) -> ReferenceTrajectory:
        if j >= len(segments):
            return trajectory
        return trajectory.followed_by(self._segments(trajectory.end, segments, j))

    def _run(
        self, q: Array, segments: Sequence[Segment], i: int, entry_speed: float
    ) -> tuple[ReferenceTrajectory, int]:
        """The reference along the lines from the i-th segment on, and the index of the segment after them."""
        j = i
        while j < len(segments) and isinstance(segments[j], Line):
            j += 1
        lines = [line for line in segments[i:j] if isinstance(line, Line)]
        if j == len(segments):
            lines[-1] = _stopping(lines[-1])
        key = (i, entry_speed, q.tobytes(), *(_key(line) for line in lines))
        if key not in self._runs:
            self._runs[key] = self._line_run(q, lines, i, entry_speed)
            if len(self._runs) > KEPT_RUNS:
                self._runs.popitem(last=False)
        return self._runs[key], j

    def _line_run(self, q: Array, lines: Sequence[Line], i: int, entry_speed: float) -> ReferenceTrajectory:
        run = curve_segments(self._arm.chain.forward(q), lines, i)
        if not run:
            return _standing(q, i)
        inverse = self._arm.inverse
        follower = BranchFollower(inverse, inverse.branch(q))
        try:
            return line_run(follower, run, entry_speed, q, self._limits)
        except MoveRefused as refusal:
            raise MoveRefused(f"'{lines[0].label}' to '{lines[-1].label}': {refusal}") from refusal

    def _goals(self, start: JointState, segments: Sequence[Segment], i: int) -> list[Array]:
        """Joint positions at which a segment may end; those that take the least time come first."""
        move = segments[i]
        if isinstance(move, JointMove):
            return [self._within(move)]
        assert isinstance(move, PoseMove)
        shoulder, elbow, wrist = self._arm.inverse.branch(start.q)
        found = self._arm.inverse.candidates(move.X_WT, shoulder, elbow)
        return sorted(found, key=lambda q: self._effort(q - start.q, self._arm.inverse.branch(q)[2] != wrist))

    def _effort(self, step: Array, is_flip: bool) -> float:
        return step_effort(step, self._limits.velocity, self._limits.acceleration, is_flip=is_flip)

    def _passing(self, start: JointState, q: Array, segments: Sequence[Segment], i: int) -> JointState:
        """The state in which `q` is passed on the way to the next segment.

        Joints that go on in the same direction do not stop. After Fritsch and Carlson, "Monotone piecewise
        cubic interpolation", 1980: half the harmonic mean of both average velocities, and zero where they
        differ in sign. No joint is faster than it can become, and stop again, within the shorter of both
        moves; else it would swing back first. In SLOW it is a stop: the tool's speed there has a limit.
        """
        moves = segments[i - 1], segments[i]
        assert not any(isinstance(move, Line) for move in moves)
        if any(move.mode is Mode.SLOW for move in moves):
            return JointState.at_rest(q)
        goals = self._goals(JointState.at_rest(q), segments, i)
        if not goals:
            raise MoveRefused(f"'{segments[i].label}': the pose is out of reach")
        limits = self._limits.scaled(
            min(move.speed for move in moves), min(move.acceleration for move in moves)
        )
        before, after = q - start.q, goals[0] - q
        rates = [step / max(float((np.abs(step) / limits.velocity).max()), 1e-9) for step in (before, after)]
        are_alike = rates[0] * rates[1] > 0.0
        total = np.where(are_alike, rates[0] + rates[1], 1.0)
        v = np.where(are_alike, rates[0] * rates[1] / total, 0.0)
        # From rest to v takes a way of v / 2 (v / a + JERK_TIME), or less; see `change_length`.
        shorter, half = np.minimum(np.abs(before), np.abs(after)), 0.5 * JERK_TIME
        fastest = limits.acceleration * (np.sqrt(half**2 + 2.0 * shorter / limits.acceleration) - half)
        return JointState(q, np.clip(v, -fastest, fastest), np.zeros(len(q)))

    def _within(self, move: JointMove) -> Array:
        q, arm = np.asarray(move.q, dtype=float), self._arm
        if q.shape != (arm.chain.n,) or not arm.inverse.is_within(q):
            raise MoveRefused(
                f"'{move.label}': joints {q.round(3).tolist()} rad; allowed: "
                f"{arm.limits.lower.round(3).tolist()} to {arm.limits.upper.round(3).tolist()}"
            )
        return q

    def _check(self, trajectory: ReferenceTrajectory) -> None:
        """Check the ranges of the joints, which ruckig does not know."""
        limits = self._arm.limits
        beyond = (trajectory.q < limits.lower) | (trajectory.q > limits.upper)
        if np.any(beyond):
            joint = int(np.argwhere(beyond)[0][1])
            raise MoveRefused(f"joint {limits.names[joint]} would leave its range on the way")


def _key(line: Line) -> Hashable:
    """What decides the reference along a line."""
    speeds = line.speed, line.acceleration, line.entry_speed, line.exit_speed, line.blend
    return line.X_WT.p.tobytes(), line.X_WT.q.tobytes(), *speeds


def _stopping(line: Line) -> Line:
    """The same line with exit speed and blend 0: a path ends at rest."""
    return Line(line.X_WT, line.speed, line.acceleration, line.entry_speed, 0.0, 0.0, line.label, line.mode)


def _standing(q: Array, segment: int) -> ReferenceTrajectory:
    """A reference that stands at `q`; two rows with rising times, as every reference has."""
    rows = np.zeros((2, len(q)))
    return ReferenceTrajectory(np.array([0.0, 1e-6]), rows + q, rows, rows, np.full(2, segment))
