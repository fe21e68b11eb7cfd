"""What the arm does with a block: an action is one or two of these, and each may be more than it can do."""

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
"""Deeds nearer to each other than this are alike: what the arm cannot do here it cannot do there [m]."""


class DeedKind(IntEnum):
    """The values of pack_interfaces/BlockDeed."""

    GRASP = 1
    PLACE = 2
    PUSH = 3


@dataclass(frozen=True)
class Deed:
    """A grasp, or putting down, or a push.

    Attributes:
        kind: which.
        at: where the block stands when it is grasped, put down, or begun to be pushed; its yaw is the heading
            that the gripper closes along, or pushes along.
    """

    kind: DeedKind
    at: PlanarPose

    def is_like(self, kind: DeedKind, poses: Array) -> npt.NDArray[np.bool_]:
        """Which deeds of a kind at poses `(..., 3)` are like this one `(...)`."""
        if kind is not self.kind:
            return np.zeros(poses.shape[:-1], dtype=bool)
        period = 2 * np.pi if kind is DeedKind.PUSH else np.pi
        distances = np.linalg.norm(poses[..., :2] - self.at.p, axis=-1)
        turns = np.abs(wrapped(poses[..., 2] - self.at.yaw, period))
        return np.asarray((distances <= NEAR) & (turns <= np.deg2rad(NEAR_DEG)))


def deeds_of(action: Action) -> tuple[Deed, ...]:
    """In the order in which they are done."""
    start, end = action.start, action.end
    if isinstance(action, Push):
        return (Deed(DeedKind.PUSH, PlanarPose(start.x, start.y, action.direction)),)
    return (
        Deed(DeedKind.GRASP, PlanarPose(start.x, start.y, action.pick_yaw)),
        Deed(DeedKind.PLACE, PlanarPose(end.x, end.y, action.place_yaw)),
    )


def is_refused(action: Action, refused: Iterable[Deed]) -> bool:
    """The action needs a deed like one of those refused."""
    deeds = deeds_of(action)
    return any(no.is_like(deed.kind, np.array(deed.at.row)) for no in refused for deed in deeds)
