"""The motion controller: it turns motion targets into joint setpoints, step by step, without a clock."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pack_core.errors import PackError
from pack_core.joints import JointSample
from pack_core.motion.moves import UP, JointMove, Line, Mode, Path, PoseMove, Retreat, Transfer
from pack_core.motion.target import Acceptance, MotionState, MotionStatus, MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import Surrounding, with_carried
from pack_motion.move_monitor import MoveMonitor
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import JointState, ReferenceTrajectory
from pack_motion.rmpflow.spheres import arm_spheres
from pack_motion.safety.separation_monitor import Margin
from pack_motion.target_planner import PreparedTarget, TargetPlanner, unwound
from pack_motion.tracking.config import MotionSet, Reference
from pack_motion.tracking.obstacles import MovingObstacles, ObstacleField
from pack_motion.tracking.pursuit import Pursuit, pursuit_of
from pack_motion.tracking.tracker import PolicyInputs, Tracker

UNFINISHED = (MotionState.MOVING, MotionState.SETTLING)
"""States of a move that is not finished."""
SHORT = 1e-6
"""Duration of a reference that stands still [s]; rows need rising times."""
RISES = (0.1, 0.2, 0.3, 0.5, 0.7)
"""Heights by which the tool is raised first, where the move cannot continue from its present pose [m]."""


def left_of(target: MotionTarget, plan: MotionPlan, segment: int, state: MotionState) -> MotionTarget | None:
    """A target with the segments of a plan from the running one on; None where the move is finished.

    A line begins at the present tool pose now and is not quite the planned one, so that the corner after it
    is not rounded.
    """
    if state not in UNFINISHED or target.move == Path(()):
        return None
    first, *others = plan.segments[segment:]
    if isinstance(first, Line):
        first = replace(first, blend=0.0)
    return replace(target, move=Path((first, *others)))


def rising(target: MotionTarget, X_WT: Pose) -> tuple[MotionTarget, ...]:
    """The rest of a move after a straight rise from X_WT, for each height of `RISES`.

    They are tried where the arm came to rest too low to continue at once; a line needs none.
    """
    assert isinstance(target.move, Path)
    first = target.move.segments[0]
    if isinstance(first, Line):
        return ()
    rises = [Line(Pose(X_WT.p + height * UP, X_WT.q), exit_speed=0.25, label=first.label) for height in RISES]
    return tuple(replace(target, move=Path((rise, *target.move.segments))) for rise in rises)


def standing_plan(q: Array, interrupted: MotionPlan, segment: int) -> MotionPlan:
    """A plan that stands at `q` `(n,)` [rad], with the goal and the running label of another plan."""
    rest = np.zeros((2, len(q)))
    trajectory = ReferenceTrajectory(
        np.array([0.0, SHORT]), rest + q, rest, rest, np.zeros(2, dtype=np.int64)
    )
    label = interrupted.segments[segment].label
    return MotionPlan(trajectory, (JointMove(q, label=label),), interrupted.X_WT)


ON_PLAN = 1e-4
"""A joint that is no farther from its reference follows the plan [rad]: tracking leaves less than that."""
LONGEST_STEP = 0.1
"""Longest step that is integrated [s]; a longer one is a gap in the measurements and an error."""


class MotionController:
    """Moves one arm.

    Args:
        arm: the arm that moves.
        config: a named set of parameters.
        time: now [s].
        q: joint positions at the start, at rest `(n,)` [rad].
    """

    def __init__(self, arm: MotionArm, config: MotionSet, time: float, q: Array) -> None:
        self._arm, self._config = arm, config
        self._planner = TargetPlanner(arm, config.clearance, config.limit_share)
        self._arm_spheres = arm_spheres(arm, config.first_sphere_link)
        self.reset(time, q)

    def reset(self, time: float, q: Array) -> None:
        """Start over with the arm at rest at `q` `(n,)`."""
        self._time = time
        self._mode = Mode.FAST
        self._is_held = False
        self._left: MotionTarget | None = None
        self._resumed: MotionTarget | None = None
        self._pursuit: Pursuit
        self._tracker = Tracker(self._arm, self._config, np.array(q, dtype=float))
        self._monitor = MoveMonitor(self._arm, self._config.stuck)
        self._moving = MovingObstacles(self._arm, time, self._config.avoiding_distance)
        standing = MotionTarget(0, Path((JointMove(self._tracker.state.q),)), is_checked=False)
        self._follow(standing, self._planner.plan(self._tracker.state, standing))
        self._monitor.stand()

    @property
    def commanded(self) -> JointState:
        """The state that the last setpoint commanded."""
        return self._tracker.state

    @property
    def time(self) -> float:
        """Time of the last setpoint [s]."""
        return self._time

    @property
    def mode(self) -> Mode:
        """The mode of the segment that is being followed, or was the last one."""
        return self._mode

    @property
    def margin(self) -> Margin:
        """How much farther than it must be the arm is from those who are seen; nobody while it is held."""
        return Margin() if self._is_held else self._pursuit.margin

    @property
    def is_under_way(self) -> bool:
        """Whether the arm's reference moves; an arm that only makes room for somebody is not under way."""
        return self._pursuit.is_moving

    @property
    def is_standing(self) -> bool:
        """Whether the joints are commanded to stand still, and the driver does not hold them."""
        return not self._is_held and self.commanded.is_at_rest

    @property
    def is_held(self) -> bool:
        """Whether the driver holds the arm; then no steps are made until it stands and `resume` is called."""
        return self._is_held

    @property
    def plan(self) -> MotionPlan:
        """The plan that is being followed."""
        return self._pursuit.plan

    def command(self, target: MotionTarget) -> Acceptance:
        """Plan a target, and follow it from the next step on.

        A target that is refused changes nothing but the status.
        """
        return self.take(self.prepare(target))

    def prepare(self, target: MotionTarget) -> PreparedTarget:
        """Plan a target from the commanded state; changes nothing, and may run in another thread."""
        X_WT = self._arm.chain.forward(self.commanded.q)
        others = rising(target, X_WT) if target is self._resumed else ()
        start = self.commanded
        if self._config.reference is Reference.STATIC:
            start = unwound(start, self._arm.limits)
        return self._planner.prepare(start, target, others)

    def take(self, prepared: PreparedTarget) -> Acceptance:
        """Follow a prepared target from the next step on; no step may have moved the arm since."""
        target, plan = prepared.target, prepared.plan
        if plan is None:
            self._monitor.refuse(target.id, prepared.reason)
            return Acceptance(False, prepared.reason)
        self._follow(target, plan)
        return Acceptance(True, "", plan.trajectory.duration)

    def stop(self) -> None:
        """Come to rest as fast as the limits allow; a move that was interrupted is given up."""
        self._left = None
        if self._is_held:
            return
        plan = self._planner.stop(self.commanded)
        self._follow(replace(self._target, move=Path(())), plan, is_stop=True)

    def refuse(self, reason: str) -> None:
        """Give the move up, as the driver does not take it, and report it as refused."""
        self.stop()
        self._monitor.refuse(self._target.id, reason)

    def wait(self, time: float) -> None:
        """Skip to `time` [s] after a gap in the measurements; allowed only while `is_standing`."""
        self._time = time

    def hold(self, reason: str) -> None:
        """Note that the driver holds the arm, away from its setpoints; lasts until `resume`."""
        self._left = left_of(self._target, self.plan, self._pursuit.segment, self._monitor.state)
        self._is_held = True
        self._monitor.hold(reason, is_unfinished=self._left is not None)

    def see(self, sample: JointSample) -> None:
        """Take a measurement of the arm while the driver holds it."""
        self._monitor.progress.see(sample, self.plan.X_WT)

    def resume(self, time: float, q: Array) -> MotionTarget | None:
        """Continue from where the arm came to rest.

        Args:
            time: now [s].
            q: measured joint positions `(n,)` [rad].

        Returns:
            The rest of the move, to be prepared and taken like any target; None where nothing is left.
        """
        plan = standing_plan(q, self.plan, self._pursuit.segment)
        self._time, self._is_held = time, False
        self._tracker = Tracker(self._arm, self._config, q)
        self._pursuit = self._pursuit_of(plan)
        left, self._left = self._left, None
        self._resumed = left
        self._monitor.resume(is_unfinished=left is not None)
        return left

    def observe(self, obstacles: Iterable[Obstacle], time: float | None = None) -> None:
        """Set the moving obstacles; those of an earlier call that are not among them are removed.

        Until the next call they are taken to go on at their velocities.

        Args:
            obstacles: the obstacles.
            time: when they were where they are said to be [s]; None: now.
        """
        self._moving.observe(obstacles, self._time if time is None else time)
        self._refresh_field()

    def step(self, time: float, sample: JointSample) -> JointState:
        """Advance to `time`; what is commanded of the joints then.

        Args:
            time: time of the setpoint [s]; later than the last one.
            sample: the newest measurement, not later than `time`.

        Raises:
            PackError: time went back, or jumped.
        """
        h = time - self._time
        if not 0.0 < h <= LONGEST_STEP:
            raise PackError(
                f"a step to {time:.4f} s from {self._time:.4f} s; allowed: forward by at most 0.1 s"
            )
        self._time = time
        pursuit, tracker = self._pursuit, self._tracker
        seen_around = self._moving.seen(time, self._target)
        before, after, posture = pursuit.advance(h, tracker.deviation, tracker.state.q, seen_around)
        mode = pursuit.plan.segments[pursuit.segment].mode
        if mode is not self._mode or self._moving:
            self._mode = mode
            self._refresh_field()
        seen = PolicyInputs(self._config.policies(mode), self._spheres, self._field)
        tracker.step(h, before, after, posture, seen)
        self._monitor.record(time, tracker.state, pursuit.segment)
        self._monitor.judge(h, sample, pursuit, self._target, self._near())
        return tracker.state

    def outlook(self) -> ReferenceTrajectory:
        """What the joints do from the last setpoint on until they rest, as far as it can be told now.

        It is the rest of the plan where the arm follows that as planned, and a stop where something holds
        the arm up or pushes it aside, or the driver holds it.
        """
        rest = self._pursuit.rest
        if rest is None or self._is_held or np.abs(rest.start.q - self.commanded.q).max() > ON_PLAN:
            return self._planner.stop(self.commanded).trajectory
        return rest

    def status(self) -> MotionStatus:
        """State and progress of the newest move."""
        return self._monitor.status(self._pursuit)

    def _follow(self, target: MotionTarget, plan: MotionPlan, *, is_stop: bool = False) -> None:
        self._target = target
        self._pursuit = self._pursuit_of(plan, is_stop=is_stop)
        self._spheres = self._arm_spheres.with_carried(self._arm, target.carried)
        self._mode = plan.segments[self._pursuit.segment].mode
        self._refresh_field()
        self._monitor.begin(target.id)

    def _pursuit_of(self, plan: MotionPlan, *, is_stop: bool = False) -> Pursuit:
        around = Surrounding(carried=self._target.carried, opening=self._target.opening)
        bodies = with_carried(self._arm, around)
        return pursuit_of(plan, self._arm, bodies, self._config, is_stop=is_stop)

    def _refresh_field(self) -> None:
        policy, tracker = self._config.policies(self._mode).collision, self._tracker
        self._field: ObstacleField = self._moving.field(
            self._time, self._target, policy, tracker.state.q, tracker.least_distance
        )

    def _near(self) -> tuple[float, tuple[str, ...]]:
        """Who the arm keeps clear of: the smallest distance [m], and names."""
        margin = self._pursuit.margin
        if margin.who:
            return margin.distance, (margin.who,)
        return self._tracker.least_distance, self._field.names


def warm_up(arm: MotionArm, config: MotionSet) -> None:
    """Plan and step once without a robot; takes half a minute if nothing has been compiled yet.

    The moves use all that is compiled: a path and a transfer, with a carried box, a standing obstacle and a
    moving one.
    """
    controller = MotionController(arm, config, 0.0, arm.home)
    X_WT = arm.chain.forward(arm.home)
    X_up = Pose(X_WT.p + 0.02 * UP, X_WT.q)
    box = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), np.full(3, 0.1))
    standing = Obstacle("standing", Pose(X_WT.p + 0.6 * UP), np.full(3, 0.05))
    moving = Obstacle("moving", Pose(X_WT.p + 0.4 * UP), np.full(3, 0.05), is_moving=True)
    hover = Retreat(UP, (0.02, 0.02))
    for move in (Path((PoseMove(X_up), Line(X_WT))), Transfer((Line(X_WT),), hover, hover)):
        controller.command(MotionTarget(0, move, box, (standing,)))
        controller.observe((moving,))
        sample = JointSample(controller.time, arm.home, np.zeros(arm.chain.n), np.zeros(arm.chain.n))
        controller.step(controller.time + config.substep, sample)
        controller.status()
