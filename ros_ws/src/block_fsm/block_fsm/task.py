"""What is to be arranged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import PlanarPose, turn_between
from pack_core.blocks.primitive_action import PrimitiveAction
from pack_core.blocks.problem import PlacedBlock, Point, Problem


@dataclass(frozen=True)
class RearrangeTask:
    """What a rearrangement is to achieve, whatever the table looks like now.

    Attributes:
        goals: X_WB by id.
        workspace: corners [m] of the convex polygon in which blocks may be put down.
        side: of a block [m].
        symmetry: after how many equal turns a block looks alike.
        gripper: its room on the table.
    """

    goals: Mapping[str, PlanarPose]
    workspace: tuple[Point, ...]
    side: float
    symmetry: int = 1
    gripper: GripperFootprint = field(default_factory=GripperFootprint)

    def problem(self, poses: Mapping[str, PlanarPose], refused: tuple[PrimitiveAction, ...] = ()) -> Problem:
        """What the planner is asked, from where the blocks are now, without what the arm `refused`.

        Blocks that nobody knows are obstacles.
        """
        return Problem(
            blocks=tuple(PlacedBlock(name, pose) for name, pose in poses.items()), goals=self.goals,
            workspace=self.workspace, side=self.side, symmetry=self.symmetry, gripper=self.gripper,
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
