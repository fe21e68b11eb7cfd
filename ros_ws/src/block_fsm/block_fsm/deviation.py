"""The table as seen against the table as predicted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from block_fsm.executor_config import ToleranceConfig
from pack_core.blocks.plan import Action, PickPlace, Push
from pack_core.blocks.planar import PlanarPose, wrapped

Poses = Mapping[str, PlanarPose]


def displaced(seen: Poses, predicted: Poses, tolerance: ToleranceConfig) -> list[str]:
    """Ids of the blocks that are not where they are predicted to be."""
    return [name for name, pose in predicted.items() if not _is_near(seen[name], pose, tolerance)]


def disturbed(before: Poses, after: Poses, moved: str, tolerance: ToleranceConfig) -> list[str]:
    """Ids of the blocks other than `moved` that an action has shifted, or that came or went meanwhile."""
    return [
        name for name in {**before, **after}
        if name != moved and not (
            name in before and name in after
            and after[name].distance_to(before[name]) <= tolerance.bystander
        )
    ]  # fmt: skip


def is_pushed_home(push: Push, seen: PlanarPose, tolerance: ToleranceConfig) -> bool:
    """Whether a pushed block is at the push's end, which is told more finely along than across it."""
    along, across = _off_the_end(push, seen)
    return (
        abs(along) <= tolerance.push_along
        and abs(across) <= tolerance.push_lateral
        and _turn_deg(seen, push.end) <= tolerance.push_angle_deg
    )


def is_on_line(push: Push, seen: PlanarPose, tolerance: ToleranceConfig) -> bool:
    """Whether a block is near enough to a push's line; pushing does not bring it there."""
    return abs(_off_the_end(push, seen)[1]) <= tolerance.push_lateral


def as_seen(action: Action, seen: PlanarPose) -> Action:
    """The action from where its block is: a push keeps to its line, and starts earlier or later on it."""
    if isinstance(action, PickPlace):
        return replace(action, start=seen)
    along, _ = _off_the_end(action, seen)
    return replace(action, start=action.end.moved(along, action.direction))


def _off_the_end(push: Push, seen: PlanarPose) -> tuple[float, float]:
    """How far a block is beyond the end of a push, and beside its line [m]."""
    c, s = np.cos(push.direction), np.sin(push.direction)
    x, y = seen.p - push.end.p
    return float(c * x + s * y), float(c * y - s * x)


def _is_near(seen: PlanarPose, predicted: PlanarPose, tolerance: ToleranceConfig) -> bool:
    return (
        seen.distance_to(predicted) <= tolerance.position
        and _turn_deg(seen, predicted) <= tolerance.angle_deg
    )


def _turn_deg(a: PlanarPose, b: PlanarPose) -> float:
    return float(abs(np.rad2deg(wrapped(a.yaw - b.yaw))))
