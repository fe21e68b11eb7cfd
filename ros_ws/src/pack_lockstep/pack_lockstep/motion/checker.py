"""Checks a plan by MuJoCo's distances between the arm's own shapes and everything around it.

It shares nothing with the planner's check but the rules: not the boxes around the shapes, not the forward
kinematics, not the moments that are looked at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import mujoco
import numpy as np

from pack_core.motion.moves import Line, Segment
from pack_core.motion.target import MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose
from pack_lockstep.motion.requests import MotionRequest
from pack_motion.arm.arm import TOOL, MotionArm
from pack_motion.reference.path_planner import MotionPlan

PERIOD = 0.008
"""Longest time between two moments that are looked at [s]."""
SLACK = 0.001
"""At its ends a gap may be smaller than right there by this [m]: lines are straight in space, not exactly."""
ROUNDING = 1e-6
"""By which limits and ends may be missed [rad] or, of limits, as a share."""
BOX = mujoco.mjtGeom.mjGEOM_BOX


@dataclass(frozen=True)
class PlanVerdict:
    """What is wrong with a plan; all empty where nothing is.

    Attributes:
        gap: the smallest gap less what is needed there [m]; negative where the plan is not clear.
        problem: what is violated first, in words.
    """

    gap: float
    problem: str

    @property
    def is_ok(self) -> bool:
        """Whether the plan may be carried out."""
        return not self.problem


class PlanChecker:
    """Checks plans for one arm.

    Args:
        arm: the arm that moves.
        clearance: smallest allowed gap between the first and last lines of a move [m].
    """

    def __init__(self, arm: MotionArm, clearance: float) -> None:
        self._arm, self._clearance = arm, clearance

    def check(self, request: MotionRequest, plan: MotionPlan) -> PlanVerdict:
        """The verdict on a plan for a request: its ends, the joints' limits, and the gaps all along."""
        gap = self._gap(request.target, plan)
        problem = self._ends(request, plan) or self._limits(plan)
        if not problem and gap < 0.0:
            problem = f"{-1000 * gap:.1f} mm nearer to an obstacle than allowed"
        return PlanVerdict(gap, problem)

    def _ends(self, request: MotionRequest, plan: MotionPlan) -> str:
        rows, goal = plan.trajectory, _goal(request.target)
        if np.abs(rows.q[0] - request.start.q).max() > ROUNDING:
            return "it does not begin where the arm is"
        X_WT = self._arm.chain.forward(rows.q[-1])
        if isinstance(goal, Pose):
            off = float(np.linalg.norm(X_WT.p - goal.p))
        else:
            off = float(np.abs(rows.q[-1] - goal).max())
        return "it does not end at the goal" if off > ROUNDING else ""

    def _limits(self, plan: MotionPlan) -> str:
        rows, limits = plan.trajectory, self._arm.limits
        for what, values, most in (
            ("velocity", rows.v, limits.velocity), ("acceleration", rows.a, limits.acceleration)
        ):  # fmt: skip
            if (np.abs(values) / most).max() > 1.0 + ROUNDING:
                return f"a joint's {what} limit is exceeded"
        is_within = np.all(rows.q >= limits.lower - ROUNDING) and np.all(rows.q <= limits.upper + ROUNDING)
        return "" if is_within else "a joint leaves its range"

    def _gap(self, target: MotionTarget, plan: MotionPlan) -> float:
        """The smallest gap less what is needed there [m]."""
        standing = [item for item in target.obstacles if not item.is_moving]
        if not standing:
            return self._clearance
        rows = plan.trajectory
        looks = np.searchsorted(rows.times, np.arange(0.0, rows.duration, PERIOD))
        moments = np.unique(np.append(looks, len(rows.times) - 1))
        gaps = self._gaps(rows.q[moments], target, standing)
        least = np.array([-np.inf if item.name in target.contacts else 0.0 for item in standing])
        first, last = _end_lines(plan.segments)
        segment = rows.segment[moments]
        needed = np.full(gaps.shape, self._clearance)
        for near, end in ((segment <= first, 0), (segment >= last, -1)):
            needed[near] = np.minimum(needed[near], np.maximum(gaps[end] - SLACK, least))
        return float((gaps - needed).min())

    def _gaps(self, q: Array, target: MotionTarget, standing: Sequence[Obstacle]) -> Array:
        """Gaps `(T, k, m)` [m] of k shapes and m obstacles, exact up to twice the clearance."""
        spec, far = self._arm.spec.copy(), 2.0 * self._clearance
        if target.carried is not None:
            at, size = target.carried.X_TB, 0.5 * target.carried.size
            spec.body(TOOL).add_geom(type=BOX, size=size, pos=at.p, quat=at.q, contype=1)
        for item in standing:
            name, at = f"obstacle {item.name}", item.X_WO
            spec.worldbody.add_geom(name=name, type=BOX, size=0.5 * item.size, pos=at.p, quat=at.q)
        model = spec.compile()
        data = mujoco.MjData(model)
        obstacles = [model.geom(f"obstacle {item.name}").id for item in standing]
        shapes = [
            geom for geom in range(model.ngeom)
            if (model.geom_contype[geom] or model.geom_conaffinity[geom])
            and model.body_weldid[model.geom_bodyid[geom]] != 0
        ]  # fmt: skip
        joints = [model.joint(name).qposadr[0] for name in self._arm.joints]
        for name in self._arm.finger_joints:
            data.qpos[model.joint(name).qposadr[0]] = 0.5 * target.opening
        gaps = np.full((len(q), len(shapes), len(obstacles)), far)
        for t, row in enumerate(q):
            data.qpos[joints] = row
            mujoco.mj_kinematics(model, data)
            apart = data.geom_xpos[shapes][:, None] - data.geom_xpos[obstacles][None]
            radii = model.geom_rbound[shapes][:, None] + model.geom_rbound[obstacles][None] + far
            for i, j in np.argwhere(np.sum(apart**2, axis=2) < radii**2):
                gaps[t, i, j] = mujoco.mj_geomDistance(model, data, shapes[i], obstacles[j], far, None)
        return gaps


def _goal(target: MotionTarget) -> Pose | Array:
    """The pose or the joint positions `(n,)` at which a target ends."""
    move = target.move
    last = move.segments[-1] if hasattr(move, "segments") else move.lines[-1]
    return last.q if hasattr(last, "q") else last.X_WT


def _end_lines(segments: Sequence[Segment]) -> tuple[int, int]:
    """Index of the last of the lines that come first, and of the first of those that come last."""
    runs = [(is_line, len(list(run))) for is_line, run in groupby(isinstance(s, Line) for s in segments)]
    first = runs[0][1] - 1 if runs[0][0] else -1
    last = len(segments) - runs[-1][1] if runs[-1][0] else len(segments)
    return first, last
