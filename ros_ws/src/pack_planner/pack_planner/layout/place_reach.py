"""Whether the arm can put a box down at a place on the pallet, on its way in, before that is decided."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pack_core.motion.moves import UP
from pack_core.motion.world import Obstacle
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.cell import PALLET, PalletizingCell
from pack_core.palletizing.orders.layout_plan import Insertion
from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import Array, Pose, from_yaw, multiply
from pack_motion.arm.arm import load_arm
from pack_motion.clearance.check import ClearanceCheck, Surrounding
from pack_planner.layout.insertion_direction import INSERTION_RULES, InsertionConfig

LIFT, STANDOFF = 0.1, 0.02
"""Above and beside its place the box's last straight way begins [m]: what the state machine does at least."""
LOOKING_DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""q_PT, wxyz, of a tool that points down: half a turn about x."""
FREE = 0.015
"""Least distance of arm and box from what stands, where that way begins [m]: the motion keeps 12 mm there."""
CLEAR = 0.005
"""Least distance of arm and gripper from boxes that stand [m]: what a box of the pad's width leaves."""
QUARTERS = [multiply(from_yaw(n * np.pi / 2.0), LOOKING_DOWN) for n in range(4)]
"""Orientations of the tool over a box, which is symmetric under quarter turns of the pad."""


class PlaceReach:
    """Asks for the two ends of the last straight way to a place, whether the arm reaches them and is clear.

    Args:
        cell: the cell, whose arm and pallet are meant.
        config: how the side is chosen from which a box comes.
        place: name of the pallet's place.
    """

    def __init__(self, cell: PalletizingCell, config: InsertionConfig, place: str = PALLET) -> None:
        deck = cell.deck(place)
        length, width = deck.size
        self._pallet = OrderPallet(length=length, width=width, deck_height=float(deck.X_WD.p[2]))
        self._X_WP, self._config = deck.X_WD, config
        self._check = ClearanceCheck(load_arm("palletizing"), CLEAR)

    def insertion(self, box: PlacedBox, placed: Sequence[PlacedBox]) -> Insertion:
        """The way on which a box comes to its place beside what stands already."""
        return INSERTION_RULES[self._config.rule](box, placed, self._config, self._pallet)

    def allows(self, box: PlacedBox, placed: Sequence[PlacedBox]) -> bool:
        """Whether the arm reaches a place from a point above and beside it, with the tool looking down.

        Box, arm and gripper must be clear there of what stands: a place between much higher neighbours can be
        too narrow for the box on its way down, and one beside a higher box too narrow for the gripper.

        Args:
            box: the box at its place.
            placed: what stands already.
        """
        insertion = self.insertion(box, placed)
        top = box.centre + np.array([0.0, 0.0, 0.5 * box.size[2]])
        standing = tuple(
            Obstacle(other.id, self._X_WP @ Pose(other.centre), other.size)
            for other in placed
            if other.upper[2] > top[2]  # nothing of arm or gripper is lower than the face that it holds
        )
        is_free, is_clear = (self._check.gate(Surrounding(standing), least) for least in (FREE, CLEAR))
        offsets = [insertion.offset(STANDOFF, LIFT), LIFT * UP][: 2 if insertion.corridor > 0.0 else 1]
        starts = [offset for offset in offsets if _is_free(box.moved(offset), placed)]
        return any(
            self._reaches(top, q_PT, is_clear)
            and any(self._reaches(top + offset, q_PT, is_free) for offset in starts)
            for q_PT in QUARTERS
        )

    def _reaches(self, p_PT: Array, q_PT: Array, is_clear: Callable[[Array], bool]) -> bool:
        found = arm_kinematics().inverse.solve(self._X_WP @ Pose(p_PT, q_PT))
        within = (q for q in found.values() if np.all((q >= LIMITS.lower) & (q <= LIMITS.upper)))
        return any(is_clear(q[None]) for q in within)


def _is_free(box: PlacedBox, placed: Sequence[PlacedBox]) -> bool:
    """Whether a box at the beginning of its last straight way keeps `FREE` from all that stands."""
    return all(float(np.max(box.clearance(other))) >= FREE for other in placed)
