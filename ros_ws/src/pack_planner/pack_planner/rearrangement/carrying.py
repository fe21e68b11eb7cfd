"""From the room that a grasp takes to the action: how a block is turned while it is carried."""

from __future__ import annotations

import numpy as np

from pack_core.blocks.plan import PickPlace
from pack_core.blocks.planar import QUARTER, PlanarPose, turn_between, wrapped
from pack_core.blocks.problem import Problem
from pack_core.rotations import Array

FITTING = 1e-6
"""A block that is turned by less than this against its goal is turned as its goal asks [rad]."""


def carried(
    problem: Problem, block: str, pose: PlanarPose, spot: Array, end: Array, axes: tuple[int, int]
) -> PickPlace:
    """A block at `pose` is carried to the place `end` `(3,)`.

    Places are squares, so that their yaws count by quarters only. The gripper closes along `axes` of the
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
