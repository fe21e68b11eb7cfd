"""The actions of a plan as plain values, for files: poses are x [m], y [m], yaw [rad]."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from pack_core.blocks.plan import Action, PickPlace, Push
from pack_core.blocks.planar import PlanarPose


def to_record(actions: Iterable[Action]) -> list[dict[str, Any]]:
    """One mapping an action; a push has no `grasp`."""
    return [
        {"block": a.block, "start": list(a.start.row), "end": list(a.end.row)}
        | ({"grasp": a.grasp} if isinstance(a, PickPlace) else {})
        for a in actions
    ]


def from_record(record: Iterable[Mapping[str, Any]]) -> tuple[Action, ...]:
    """The actions that `to_record` wrote."""
    return tuple(_action(row) for row in record)


def _action(row: Mapping[str, Any]) -> Action:
    start, end = PlanarPose(*row["start"]), PlanarPose(*row["end"])
    if "grasp" in row:
        return PickPlace(row["block"], start, end, row["grasp"])
    return Push(row["block"], start, end)
