"""A rearrangement plan: what to do, one block at a time, and what is known about it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from itertools import pairwise, zip_longest
from typing import Any

import numpy as np

from pack_core.blocks.planar import QUARTER, PlanarPose, wrapped

AT_GOAL = 1e-6
"""An action that ends this near a goal ends at it [m]; planned poses are exact but for rounding."""


class PlanStatus(IntEnum):
    """Outcome; the values of pack_interfaces/PlanRearrangement."""

    OPTIMAL = 1
    """A plan that is as short as the lower bound."""
    FEASIBLE = 2
    """A plan; a shorter one may exist."""
    TIMEOUT = 3
    """No plan was found in the time given; whether there is one is not known."""
    INFEASIBLE = 4
    """There is no plan; the diagnosis is the proof."""
    INVALID_INPUT = 5
    """The problem contradicts itself; the diagnosis says where."""


@dataclass(frozen=True)
class PickPlace:
    """Grasp a block, carry it over the others, put it down.

    Attributes:
        block: its id.
        start: X_WB before.
        end: X_WB after.
        grasp: the block's own axis that the gripper closes along, 0 for x, 1 for y.
    """

    block: str
    start: PlanarPose
    end: PlanarPose
    grasp: int

    @property
    def pick_yaw(self) -> float:
        """Heading [rad] that the gripper closes along at the start; a half turn more is the same."""
        return self.start.yaw + self.grasp * QUARTER

    @property
    def place_yaw(self) -> float:
        """Heading [rad] that the gripper closes along at the end."""
        return self.end.yaw + self.grasp * QUARTER


@dataclass(frozen=True)
class Push:
    """Slide a block straight along one of its axes, with the gripper almost closed behind it.

    Attributes:
        block: its id.
        start: X_WB before.
        end: X_WB after; of the same yaw.
    """

    block: str
    start: PlanarPose
    end: PlanarPose

    @property
    def direction(self) -> float:
        """Heading of the push [rad]; the gripper closes across it."""
        return float(np.arctan2(self.end.y - self.start.y, self.end.x - self.start.x))

    @property
    def distance(self) -> float:
        """Length of the push [m]."""
        return self.start.distance_to(self.end)


Action = PickPlace | Push


@dataclass(frozen=True)
class Diagnosis:
    """Why there is no plan, in words, and the ids of the blocks concerned."""

    text: str = ""
    blocks: tuple[str, ...] = ()


@dataclass(frozen=True)
class PlanStatistics:
    """How a plan came about; times are those of the clock handed to the planner [s]."""

    setup_s: float = 0.0
    first_plan_s: float = np.nan
    """From the call to the first plan; NaN without one."""
    first_actions: int = 0
    total_s: float = 0.0
    expanded: int = 0
    """States expanded (beam), or paths planned (pirs)."""


@dataclass(frozen=True)
class Plan:
    """What the rearrangement planner answers with.

    Attributes:
        status: how it ended.
        actions: in order; empty without a plan, and when all blocks are in place.
        lower_bound: no plan has fewer actions.
        diagnosis: why there is no plan.
        statistics: how it came about.
    """

    status: PlanStatus
    actions: tuple[Action, ...] = ()
    lower_bound: int = 0
    diagnosis: Diagnosis = field(default_factory=Diagnosis)
    statistics: PlanStatistics = field(default_factory=PlanStatistics)

    @property
    def is_solved(self) -> bool:
        """There are actions to carry out, or none are needed."""
        return self.status in (PlanStatus.OPTIMAL, PlanStatus.FEASIBLE)

    def states(self, starts: Mapping[str, PlanarPose]) -> Iterator[dict[str, PlanarPose]]:
        """Predicted poses of all blocks: at the start and after every action."""
        poses = dict(starts)
        yield dict(poses)
        for action in self.actions:
            poses[action.block] = action.end
            yield dict(poses)

    def travel(self) -> float:
        """Path of the gripper from the first action's start on, seen from above [m]."""
        stops = [pose.p for action in self.actions for pose in (action.start, action.end)]
        return float(np.linalg.norm(np.diff(stops, axis=0), axis=1).sum()) if stops else 0.0

    def turns(self) -> float:
        """Turns of the wrist while it holds a block, summed [rad]."""
        return sum(abs(float(wrapped(a.end.yaw - a.start.yaw))) for a in self.actions)

    def cleared(self, goals: Mapping[str, PlanarPose]) -> int:
        """How often a block is brought elsewhere than to its goal, by one action or several in a row."""
        last = [a for a, b in zip_longest(self.actions, self.actions[1:]) if b is None or a.block != b.block]
        return sum(a.end.distance_to(goals[a.block]) > AT_GOAL for a in last)

    def regrasps(self) -> int:
        """How often a block that was just put down is picked up again, by the other grasp or elsewhere."""
        carries = [isinstance(a, PickPlace) for a in self.actions]
        blocks = [a.block for a in self.actions]
        steps = zip(pairwise(blocks), pairwise(carries), strict=True)
        return sum(first == second and all(both) for (first, second), both in steps)


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
