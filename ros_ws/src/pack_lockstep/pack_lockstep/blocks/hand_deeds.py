"""What a hand can do to the blocks and the camera of the blocks cell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.rotations import Array, Pose
from pack_lockstep.blocks.lockstep import BlocksLockstep

STRANGER = "stranger"
"""A block whose tag nobody knows; it is out of reach until a hand brings it."""
AWAY = PlanarPose(100.0, 100.0, 0.0)
TURN, SHIFT = np.deg2rad(20.0), 0.015


@dataclass
class BlocksReach:
    """What a hand can reach: the cell, the problem, and the block that is meant."""

    cell: BlocksLockstep
    problem: Problem
    block: str
    put: PlanarPose | None = None

    @property
    def poses(self) -> dict[str, PlanarPose]:
        """Where all blocks truly are."""
        return {name: PlanarPose.of(o.X_WO) for name, o in self.cell.simulator.truth().objects.items()}

    def move(self, block: str, pose: PlanarPose) -> None:
        """Put a block somewhere on the table."""
        self.cell.simulator.put(block, pose.pose(0.5 * self.problem.side))

    def bring(self, pose: PlanarPose) -> None:
        """Put the stranger somewhere on the table."""
        self.put = pose
        self.move(STRANGER, pose)


BlocksDeed = Callable[[BlocksReach], None]


def _remove(reach: BlocksReach) -> None:
    reach.cell.simulator.put(reach.block, Pose(np.array([*AWAY.p, 0.0])))


def _turn(reach: BlocksReach) -> None:
    pose = reach.poses[reach.block]
    reach.move(reach.block, PlanarPose(pose.x, pose.y, pose.yaw + TURN))


def _shift(reach: BlocksReach) -> None:
    """Away from the nearest other block."""
    poses = reach.poses
    pose = poses[reach.block]
    nearest = min((p for name, p in poses.items() if name != reach.block), key=pose.distance_to)
    away = (pose.p - nearest.p) / pose.distance_to(nearest)
    reach.move(reach.block, PlanarPose(pose.x + SHIFT * away[0], pose.y + SHIFT * away[1], pose.yaw))


def _add_in_free_place(reach: BlocksReach) -> None:
    taken = [*reach.poses.values(), *reach.problem.goals.values()]
    reach.bring(_farthest(_lattice(reach.problem), taken))


def _add_on_goal(reach: BlocksReach) -> None:
    goals = list(reach.problem.goals.values())
    reach.bring(_farthest(goals, list(reach.poses.values())))


def _silence_camera(reach: BlocksReach) -> None:
    reach.cell.camera_is_silent = True


def _lattice(problem: Problem) -> list[PlanarPose]:
    """Places within the workspace, its outermost ones left out."""
    corners: Array = np.array(problem.workspace)
    low, high = corners.min(axis=0) + problem.side, corners.max(axis=0) - problem.side
    return [PlanarPose(x, y, 0.3) for x in np.linspace(low[0], high[0], 15)
            for y in np.linspace(low[1], high[1], 15)]  # fmt: skip


def _farthest(places: list[PlanarPose], taken: list[PlanarPose]) -> PlanarPose:
    return max(places, key=lambda place: min(place.distance_to(other) for other in taken))


DEEDS: dict[str, BlocksDeed] = {
    "block removed": _remove,
    "block turned by 20 degrees": _turn,
    "block shifted by 15 mm": _shift,
    "another block put in a free place": _add_in_free_place,
    "another block put on a goal": _add_on_goal,
    "camera silent": _silence_camera,
}
REMOVED, TURNED, SHIFTED, FREE, ON_GOAL, CAMERA = DEEDS
