"""The primitive actions that an action of a plan consists of, by which the arm's refusals are told.

A pick-and-place action is a grasp and a place, a push is one primitive action. The arm may refuse any of them
because its path is out of reach or too near something; a plan then has to do without ones like it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from pack_core.blocks.plan import Action, Push
from pack_core.blocks.planar import PlanarPose, wrapped
from pack_core.rotations import Array

NEAR, NEAR_DEG = 0.003, 3.0
"""Up to this distance [m] and turn two primitive actions are alike: where one is refused, so is the other."""


class PrimitiveKind(IntEnum):
    """What the gripper does to a block; the values of pack_interfaces/PrimitiveAction."""

    GRASP = 1
    PLACE = 2
    PUSH = 3


@dataclass(frozen=True)
class PrimitiveAction:
    """A grasp, a place or a push.

    Attributes:
        kind: which of them.
        at: where the block stands when it is grasped, put down, or begun to be pushed; its yaw is the heading
            that the gripper closes along, or pushes along.
    """

    kind: PrimitiveKind
    at: PlanarPose

    def is_like(self, kind: PrimitiveKind, poses: Array) -> npt.NDArray[np.bool_]:
        """Which primitive actions of a kind at poses `(..., 3)` are like this one `(...)`."""
        if kind is not self.kind:
            return np.zeros(poses.shape[:-1], dtype=bool)
        # Two fingers that close along a heading are the same after half a turn; a push has a direction.
        period = 2 * np.pi if kind is PrimitiveKind.PUSH else np.pi
        distances = np.linalg.norm(poses[..., :2] - self.at.p, axis=-1)
        turns = np.abs(wrapped(poses[..., 2] - self.at.yaw, period))
        return np.asarray((distances <= NEAR) & (turns <= np.deg2rad(NEAR_DEG)))


def primitives_of(action: Action) -> tuple[PrimitiveAction, ...]:
    """The primitive actions of an action, in the order in which they are done."""
    start, end = action.start, action.end
    if isinstance(action, Push):
        return (PrimitiveAction(PrimitiveKind.PUSH, PlanarPose(start.x, start.y, action.direction)),)
    return (
        PrimitiveAction(PrimitiveKind.GRASP, PlanarPose(start.x, start.y, action.pick_yaw)),
        PrimitiveAction(PrimitiveKind.PLACE, PlanarPose(end.x, end.y, action.place_yaw)),
    )


def is_refused(action: Action, refused: Iterable[PrimitiveAction]) -> bool:
    """Whether the action needs a primitive action like one of those refused."""
    needed = primitives_of(action)
    return any(no.is_like(one.kind, np.array(one.at.row)) for no in refused for one in needed)
