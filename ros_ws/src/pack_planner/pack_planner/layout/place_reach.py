"""Whether the arm can put a box down at a place on the pallet, on its way in, before that is decided."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from pack_core.kinematics.chain import SerialChain
from pack_core.motion.moves import UP
from pack_core.motion.world import Obstacle
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.cell import PALLET, PalletizingCell
from pack_core.palletizing.orders.layout_plan import Insertion
from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import POINTING_DOWN, Array, Pose, to_matrix
from pack_motion.arm.arm import load_arm
from pack_motion.arm.bodies import BodyBoxes
from pack_motion.clearance.check import ClearanceCheck, Surrounding
from pack_planner.layout.insertion_direction import INSERTION_RULES, InsertionConfig

LIFT, STANDOFF = 0.1, 0.02
"""Above and beside its place the box's last straight way begins [m]: what the state machine does at least."""
FREE = 0.015
"""Least distance of box and gripper on the way down, unless they are nearer at the place [m]:
the motion keeps 12 mm there."""
ROUNDING = 1e-6
"""By which a gap may be smaller than at the place [m]."""
CLEAR = 0.005
"""Least distance of the gripper from boxes that stand [m]: what a box of the pad's width leaves."""


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
        arm = load_arm("palletizing")
        is_hand = arm.bodies.link == arm.chain.n - 1
        self._hand = _corners(_some(arm.bodies, is_hand), arm.chain)
        self._check = ClearanceCheck(replace(arm, bodies=_some(arm.bodies, ~is_hand)), FREE)

    def insertion(self, box: PlacedBox, placed: Sequence[PlacedBox]) -> Insertion:
        """The way on which a box comes to its place beside what stands already."""
        return INSERTION_RULES[self._config.rule](box, placed, self._config, self._pallet)

    def allows(self, box: PlacedBox, placed: Sequence[PlacedBox]) -> bool:
        """Whether the arm reaches a place from a point above and beside it, with the tool looking down.

        Box and arm must be clear of what stands, on the way straight down to that point, too: a place below
        much higher boxes can be too narrow for the box on its way, and one beside a higher box too narrow for
        the gripper.

        Args:
            box: the box at its place.
            placed: what stands already.
        """
        insertion = self.insertion(box, placed)
        top = box.centre + np.array([0.0, 0.0, 0.5 * box.size[2]])
        lower, upper = (
            np.vstack([top + self._hand[0], box.lower]),
            np.vstack([top + self._hand[1], box.upper]),
        )
        others = np.array([[other.lower, other.upper] for other in placed]).reshape(-1, 2, 3)
        gaps = _gaps(lower, upper, others)
        if np.any(gaps[:-1] < CLEAR):
            return False
        up = np.array([0.0, 0.0, np.inf])
        beside = insertion.offset(STANDOFF, 0.0)
        ways = [
            (top, top + offset, top + offset + LIFT * UP)
            for offset in (beside, np.zeros(3))
            if np.all(_gaps(lower + offset, upper + offset + up, others) >= np.minimum(gaps, FREE) - ROUNDING)
        ]
        standing = tuple(
            Obstacle(other.id, self._X_WP @ Pose(other.centre), other.size)
            for other in placed
            if other.upper[2] > top[2]  # nothing of the arm is lower than the face that it holds
        )
        is_clear = self._check.gate(Surrounding(standing), FREE)
        return any(all(self._reaches(point, is_clear) for point in way) for way in ways)

    def _reaches(self, p_PT: Array, is_clear: Callable[[Array], bool]) -> bool:
        found = arm_kinematics().inverse.solve(self._X_WP @ Pose(p_PT, POINTING_DOWN))
        within = (q for q in found.values() if np.all((q >= LIMITS.lower) & (q <= LIMITS.upper)))
        return any(is_clear(q[None]) for q in within)


def _some(bodies: BodyBoxes, are_meant: npt.NDArray[np.bool_]) -> BodyBoxes:
    own = np.flatnonzero(are_meant)
    names = tuple(bodies.names[i] for i in own)
    return BodyBoxes(names, bodies.link[own], bodies.R[own], bodies.p[own], bodies.half[own])


def _corners(hand: BodyBoxes, chain: SerialChain) -> tuple[Array, Array]:
    """Lower and upper corners `(k, 3)` of all that is fixed to the last link, from the pad's middle [m].

    The tool looks down; a quarter turn of it about the vertical changes nothing, as all is square.
    """
    R_PT = to_matrix(POINTING_DOWN)
    # Bodies are given where all joints are zero, and chain.R_WT and p_WT are the tool's pose there.
    centres = (hand.p - chain.p_WT) @ chain.R_WT @ R_PT.T
    half = np.einsum("ij,kjl,kl->ki", np.abs(R_PT @ chain.R_WT.T), np.abs(hand.R), hand.half)
    return centres - half, centres + half


def _gaps(lower: Array, upper: Array, others: Array) -> Array:
    """Distances `(k, n)` of blocks `(k, 3)` from others `(n, 2, 3)`, each along its largest axis [m]."""
    return np.asarray(np.maximum(lower[:, None] - others[:, 1], others[:, 0] - upper[:, None]).max(axis=2))
