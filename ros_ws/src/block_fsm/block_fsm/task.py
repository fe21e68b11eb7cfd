"""What is to be arranged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import PlanarPose, turn_between
from pack_core.blocks.primitive_action import PrimitiveAction
from pack_core.blocks.problem import CUBE, BlockSize, BlockSizes, PlacedBlock, Point, Problem


@dataclass(frozen=True)
class RearrangeTask:
    """What a rearrangement is to achieve, whatever the table looks like now.

    Attributes:
        goals: X_WB by id.
        workspace: corners [m] of the convex polygon in which blocks may be put down.
        sizes: of the blocks that are not cubes, by id; blocks that nobody knows are taken for cubes.
        symmetry: after how many equal turns a block looks alike.
        gripper: its room on the table.
    """

    goals: Mapping[str, PlanarPose]
    workspace: tuple[Point, ...]
    sizes: BlockSizes = field(default_factory=dict)
    symmetry: int = 1
    gripper: GripperFootprint = field(default_factory=GripperFootprint)

    @classmethod
    def of(cls, problem: Problem) -> RearrangeTask:
        """What a problem is to achieve."""
        return cls(problem.goals, problem.workspace, problem.sizes, problem.symmetry, problem.gripper)

    def size(self, block: str) -> BlockSize:
        """Of a block."""
        return self.sizes.get(block, CUBE)

    def problem(self, poses: Mapping[str, PlanarPose], refused: tuple[PrimitiveAction, ...] = ()) -> Problem:
        """What the planner is asked, from where the blocks are now, without what the arm `refused`.

        Blocks that nobody knows are obstacles.
        """
        return Problem(
            blocks=tuple(PlacedBlock(name, pose, self.size(name)) for name, pose in poses.items()),
            goals=self.goals, workspace=self.workspace, symmetry=self.symmetry, gripper=self.gripper,
            starts_may_be_outside=True, refused=refused,
        )  # fmt: skip

    def errors(self, poses: Mapping[str, PlanarPose]) -> tuple[float, float]:
        """Largest distance [m] and turn [rad] of the blocks in `poses` from their goals; NaN without any."""
        pairs = [(pose, self.goals[name]) for name, pose in poses.items() if name in self.goals]
        if not pairs:
            return np.nan, np.nan
        return (
            max(pose.distance_to(goal) for pose, goal in pairs),
            max(abs(turn_between(pose, goal, self.symmetry)) for pose, goal in pairs),
        )
