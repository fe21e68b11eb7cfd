"""The tool's goals for the box in work, those of the quickest way to its place first.

How quick a way is, is estimated by what the joints need for it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeVar

import numpy as np

from pack_core.motion.moves import Move
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.cell import PALLET, PalletizingCell
from pack_core.palletizing.orders.handling import Handling
from pack_core.robots.joint_properties import step_effort
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import Array, Pose, to_matrix
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import ToolPoseConfig
from pallet_fsm.states import State
from pallet_fsm.tool_poses import Stand, grasps, placements, stands

TURNS = 2.0 * np.pi * np.array([[-1.0], [0.0], [1.0]])
"""By which a joint may be turned farther [rad]."""
BACK = 0.2
"""By which the arm should be able to step straight back from a box that it has stood up [m]."""
OBLIQUE = 5.0
"""What a stand counts for longer where it cannot, as oblique ways back are often out of reach, too [s]."""


def joint_time(X_from: Pose, X_to: Pose) -> float:
    """Estimated time from one tool pose to another, each at rest [s]; infinite where one is out of reach.

    Shoulder and elbow stay as they are at home. Which of both flips the wrist has at the start makes no
    difference: the steps from the other one are the same, with the flips at the end exchanged.
    """
    starts, ends = _postures(X_from), _postures(X_to)
    if not starts or not ends:
        return float("inf")
    flip, q = starts[0]
    return min(_effort(q_end - q, q, is_flip=flip_end != flip) for flip_end, q_end in ends)


def warm_up() -> None:
    """Have numba compile the inverse kinematics; loads it where that was done before."""
    arm = arm_kinematics()
    X_WT = arm.chain.forward(arm.home)
    joint_time(X_WT, X_WT)


def _postures(X_WT: Pose) -> list[tuple[int, Array]]:
    """Flip of the wrist and joint positions `(6,)` [rad] with shoulder and elbow as at home."""
    inverse, home = arm_kinematics().inverse, _home_branch()
    return [(branch[2], q) for branch, q in inverse.solve(X_WT).items() if branch[:2] == home]


@cache
def _home_branch() -> tuple[int, int]:
    arm = arm_kinematics()
    return arm.inverse.branch(arm.home)[:2]


def _effort(step: Array, q: Array, *, is_flip: bool) -> float:
    """Time of a step from `q`, each joint turned as is nearest within its range [s], with penalties."""
    steps = step + TURNS
    is_allowed = (q + steps >= LIMITS.lower) & (q + steps <= LIMITS.upper)
    shortest = np.where(is_allowed, np.abs(steps), np.inf).min(axis=0)
    return step_effort(shortest, LIMITS.velocity, LIMITS.acceleration, is_flip=is_flip)


@dataclass(frozen=True)
class Leg:
    """A move up to the next stop of the arm.

    Attributes:
        move: the move as the motion takes it.
        X_WT: pose of the tool at its end.
        end: the state in which it ends.
        approach: approach direction of the tool at the end, where it stands a box up `(3,)`; else None.
        is_checked: whether the clearance of the whole move is checked before it starts.
    """

    move: Move
    X_WT: Pose
    end: State
    approach: Array | None = None
    is_checked: bool = True


class Goals:
    """Finds tool poses over boxes, at table B and over places on the pallet.

    Args:
        cell: the cell's physical facts.
        config: distances.
    """

    def __init__(self, cell: PalletizingCell, config: ToolPoseConfig) -> None:
        self._cell, self._config = cell, config

    @property
    def drop(self) -> float:
        """How high a box is let go over what it is put on [m]."""
        return self._config.drop

    def grasps(self, item: WorkItem, X_WT: Pose) -> list[Pose]:
        """Tool poses on the top face of the box where it stands."""
        assert item.X_WB is not None
        return self._grasps(item, item.X_WB, X_WT, is_to_stand=self._is_to_stand(item))[1]

    def stands(self, item: WorkItem, X_WT: Pose) -> list[Stand]:
        """Ways to stand the gripped box up at the edge of table B."""
        assert item.X_TB is not None
        return self._stands(item, item.X_TB, X_WT)[1]

    def placements(self, item: WorkItem, X_WT: Pose) -> list[Pose]:
        """Tool poses at which the gripped box is at its place on the pallet."""
        assert item.X_TB is not None
        return self._placements(item, item.X_TB, X_WT)[1]

    def in_world(self, v_D: Array, deck: str = PALLET) -> Array:
        """A vector `(3,)` that is given along the axes of a pallet or table, along the world's.

        A pallet stands a little askew, and the boxes on it with it: a box that came down along the world's
        vertical would come nearer to a tall neighbour on its way than it is at its place.
        """
        return np.asarray(to_matrix(self._cell.deck(deck).X_WD.q) @ v_D)

    def _grasps(
        self, item: WorkItem, X_WB: Pose, X_WT: Pose, *, is_to_stand: bool
    ) -> tuple[float, list[Pose]]:
        def onward(goal: Pose) -> float:
            X_TB = goal.inverse() @ X_WB
            way = self._stands if is_to_stand else self._placements
            return way(item, X_TB, goal)[0]

        return _quickest([(goal, goal) for goal in grasps(X_WB, item.dims, self._config)], X_WT, onward)

    def _stands(self, item: WorkItem, X_TB: Pose, X_WT: Pose) -> tuple[float, list[Stand]]:
        def onward(stand: Stand) -> float:
            back = joint_time(stand.X_WT, raised(stand.X_WT, -BACK * stand.approach))
            way = self._grasps(item, stand.X_WB, stand.X_WT, is_to_stand=False)[0]
            return way + (0.0 if np.isfinite(back) else OBLIQUE)

        found = stands(item.box, X_TB, self._cell, self._config)
        return _quickest([(stand, stand.X_WT) for stand in found], X_WT, onward)

    def _placements(self, item: WorkItem, X_TB: Pose, X_WT: Pose) -> tuple[float, list[Pose]]:
        X_WD = self._cell.deck(item.deck).X_WD
        found = placements(item.plan.placed, item.box, X_TB, X_WD, self._config)
        return _quickest([(goal, goal) for goal in found], X_WT, lambda _: 0.0)

    def _is_to_stand(self, item: WorkItem) -> bool:
        """Whether the box is yet to be stood up on table B."""
        return item.handling is Handling.TABLE and item.approach is None


Way = TypeVar("Way")


def _quickest(
    ways: Sequence[tuple[Way, Pose]], X_WT: Pose, onward: Callable[[Way], float]
) -> tuple[float, list[Way]]:
    """The least estimated time from X_WT to the box's place [s], and the ways there, the quickest first."""
    times = [joint_time(X_WT, goal) + onward(way) for way, goal in ways]
    order = sorted(range(len(ways)), key=times.__getitem__)
    return min(times, default=float("inf")), [ways[i][0] for i in order]


def raised(X_WT: Pose, offset: Array) -> Pose:
    """The pose, displaced by an offset `(3,)` [m] in the world frame."""
    return Pose(X_WT.p + offset, X_WT.q)
