"""A valid problem as arrays, with blocks snapped to where they count as being."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.plan import PickPlace
from pack_core.blocks.planar import QUARTER, PlanarPose, turn_between, wrapped
from pack_core.blocks.problem import Problem
from pack_core.rotations import Array
from pack_planner.rearrangement.assembly import GoalAccess
from pack_planner.rearrangement.footprints import edges, outlines, rows_of, shapes_of


@dataclass(frozen=True)
class SnappedProblem:
    """What both methods plan on; blocks are numbered by the place of their goals.

    Attributes:
        ids: of the blocks.
        starts: poses `(n, 3)`, snapped.
        goals: poses `(n, 3)`.
        is_home: the block stands on its goal already `(n,)`.
        is_ready: the block stands where one push leads to its goal `(n,)`.
        half_planes: of the workspace `(edges, 3)`.
        problem: as given.
    """

    ids: tuple[str, ...]
    starts: Array
    goals: Array
    is_home: npt.NDArray[np.bool_]
    is_ready: npt.NDArray[np.bool_]
    half_planes: Array
    problem: Problem

    @classmethod
    def of(cls, problem: Problem) -> SnappedProblem:
        """Number the blocks and snap them."""
        goals = problem.goals
        movable = (block for block in problem.blocks if block.id in goals)
        blocks = sorted(movable, key=lambda b: (round(goals[b.id].y, 4), round(goals[b.id].x, 4)))
        snapped = [_snapped(problem, block.id, block.pose) for block in blocks]
        return cls(
            tuple(block.id for block in blocks),
            rows_of(pose for pose, _, _ in snapped),
            rows_of(goals[block.id] for block in blocks),
            np.array([is_home for _, is_home, _ in snapped], dtype=bool),
            np.array([is_ready for _, _, is_ready in snapped], dtype=bool),
            edges(problem.workspace),
            problem,
        )

    @property
    def n(self) -> int:
        """Number of blocks."""
        return len(self.ids)

    @cached_property
    def goal_access(self) -> GoalAccess:
        """What must be unfilled for a goal to be filled."""
        return GoalAccess.of(self.goals, self.shapes, self.gripper)

    @cached_property
    def obstacles(self) -> Array:
        """What stands on the table and stays there, as rectangles `(obstacles, 6)`."""
        obstacles = self.problem.obstacles
        return outlines(rows_of(obstacles.values()), self._shapes_of(obstacles))

    @cached_property
    def shapes(self) -> Array:
        """Shape of every block `(n, 3)`, see `footprints`."""
        return self._shapes_of(self.ids)

    @cached_property
    def is_square(self) -> npt.NDArray[np.bool_]:
        """Whether a block looks alike after a quarter turn `(n,)`."""
        return np.asarray(self.shapes[:, 0] == self.shapes[:, 1])

    def _shapes_of(self, ids: Iterable[str]) -> Array:
        sizes = self.problem.sizes
        return shapes_of([sizes[name] for name in ids], self.problem.tallest)

    @property
    def gripper(self) -> GripperFootprint:
        """The gripper's room on the table."""
        return self.problem.gripper


def is_at_goal(problem: Problem, block: str, pose: PlanarPose) -> bool:
    """Whether a block at a pose counts as standing on its goal."""
    goal, tolerance = problem.goals[block], problem.tolerance
    turn = abs(turn_between(pose, goal, problem.symmetry))
    return pose.distance_to(goal) <= tolerance.position and turn <= np.deg2rad(tolerance.angle_deg)


def _snapped(problem: Problem, block: str, pose: PlanarPose) -> tuple[PlanarPose, bool, bool]:
    """Where a block counts as standing, whether on its goal, and whether on a push line of it."""
    goal, tolerance, gripper = problem.goals[block], problem.tolerance, problem.gripper
    turn = turn_between(pose, goal, problem.symmetry)
    if is_at_goal(problem, block, pose):
        return PlanarPose(goal.x, goal.y, pose.yaw + turn), True, False
    for heading in goal.yaw + QUARTER * np.arange(4):
        ahead = float((goal.p - pose.p) @ [np.cos(heading), np.sin(heading)])
        on_line = goal.moved(-ahead, float(heading))
        is_near = on_line.distance_to(pose) <= tolerance.push_line
        is_turned = abs(turn) > np.deg2rad(tolerance.angle_deg)
        if is_near and not is_turned and gripper.min_push <= ahead <= gripper.max_push:
            return PlanarPose(on_line.x, on_line.y, pose.yaw + turn), False, True
    return pose, False, False


FITTING = 1e-6
"""A block that is off its goal by less than this stands as its goal asks [m, rad]."""


def carried(
    problem: Problem, block: str, pose: PlanarPose, spot: Array, end: Array, axes: tuple[int, int]
) -> PickPlace:
    """A block at `pose` is carried to the place `end` `(3,)`.

    Places of square blocks are squares, so that their yaws count by quarters only; those of oblong ones have
    the block's own axes. The gripper closes along `axes` of the
    place where the block stands, `spot` `(3,)`, and of `end`. That leaves open whether the block is turned
    by half a turn more: it ends as its goal asks, if it can, and else by the smaller turn.
    """
    closing = spot[2] + axes[0] * QUARTER
    turns = wrapped(end[2] + axes[1] * QUARTER - closing + np.pi * np.arange(2))
    goal = problem.goals[block]
    ends = [PlanarPose(float(end[0]), float(end[1]), pose.yaw + float(turn)) for turn in turns]
    off = np.array([abs(turn_between(turned, goal, problem.symmetry)) for turned in ends])
    rank = np.abs(turns) + 2 * np.pi * (off > FITTING)
    chosen = ends[int(np.argmin(rank))]
    grasp = round(float(closing - pose.yaw) / QUARTER) % 2
    return PickPlace(block, pose, PlanarPose(chosen.x, chosen.y, float(wrapped(chosen.yaw))), grasp)
