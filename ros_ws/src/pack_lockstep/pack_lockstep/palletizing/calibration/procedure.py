"""What the arm does during a calibration."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.rotations import Array, Pose, exp, from_yaw, multiply, rotate
from pack_lockstep.palletizing.calibration.measurements import BoardView, FeltContact, contact_of, corners_in
from pack_lockstep.palletizing.calibration.rig import CalibrationFailed, CalibrationRig, rotated_down
from pack_lockstep.palletizing.calibration.touch import touch
from pallet_fsm.surroundings import furniture

TILT = np.deg2rad(4.0)
"""By which the tool is tilted over a level surface, so that one corner of the pad touches it first [rad]."""
CLEAR = 0.012
"""Distance from the nominal surface at which an approach begins [m]."""
TRAVEL = 0.03
DOWN = np.array([0.0, 0.0, -1.0])
PLACES_SEEN = (
    (0.0, 0.0), (0.4, 0.0), (-0.4, 0.0), (0.0, 0.35), (0.0, -0.35),
    (0.35, 0.3), (-0.35, -0.3), (-0.35, 0.3), (0.35, -0.3),
)  # fmt: skip
"""Where the pattern is shown, from the middle of the table [m]."""
DEEP = 0.014
"""Below the deck, where its edges are touched [m]: in the upper boards, which are 22 mm thick."""
FEWEST_VIEWS = 15


@dataclass
class Measurements:
    """Everything that was measured."""

    contacts: list[FeltContact] = field(default_factory=list)
    views: list[BoardView] = field(default_factory=list)
    X_TB: Pose = field(default_factory=lambda: Pose(np.zeros(3)))
    """Nominal pose of the board in the gripper."""


Say = Callable[[str], None]


def measure(rig: CalibrationRig, say: Say) -> Measurements:
    """Touch tables and pallet, then show the board to the camera; raises CalibrationFailed."""
    found = Measurements()
    rig.obstacles = ()  # near surfaces that are to be touched no clearance can be asked for
    for number, (surface, X_WT, normal, p_TC) in enumerate(_touches(rig), 1):
        say(f"touch {number}: {surface[0]}")
        _over(rig, X_WT, normal)
        recorded = touch(rig, X_WT, normal, TRAVEL, surface, p_TC)
        found.contacts.append(contact_of(recorded, rig.arm.chain, rig.period))
        _away(rig)
    found.X_TB = _take_board(rig)
    for number, X_WT in enumerate(_views(rig, found.X_TB), 1):
        say(f"view {number}")
        try:
            rig.go(X_WT)
        except CalibrationFailed:
            continue  # out of reach, or too near to something: the others are enough
        picture, sample = rig.look()
        ids, pixels = corners_in(picture, CALIBRATION_BOARD)
        if len(ids) >= 20:
            found.views.append(BoardView(sample.q, ids, pixels))
    if len(found.views) < FEWEST_VIEWS:
        raise CalibrationFailed(
            f"the board was seen in {len(found.views)} pictures; needed: {FEWEST_VIEWS}. Is it in the light?"
        )
    _lay_board_down(rig, found.X_TB)
    return found


def _touches(rig: CalibrationRig) -> Iterator[tuple[tuple[str, int, float], Pose, Array, Array]]:
    """Surface, pose from which it is approached, direction, and the pad's corner, one after the other."""
    cell, half = rig.known, 0.5 * rig.known.tool.model_dump()["pad_size"]
    for name, reach in (("picking_table", 0.32), ("reorientation_table", 0.28)):
        table = getattr(cell, name)
        for x, y in ((0.0, 0.0), (reach, reach), (-reach, reach), (-reach, -reach), (reach, -reach)):
            p = np.array([table.centre[0] + x, table.centre[1] + y, table.height])
            yield (name, 2, table.height), *from_above(rig, p, half)
    (x_0, y_0), (l, w), deck = cell.pallet.corner, cell.pallet.size, cell.pallet.deck_height
    for x, y in ((0.5, 0.5), (0.12, 0.15), (0.88, 0.15), (0.88, 0.85), (0.35, 0.85)):
        p = np.array([x_0 + x * l, y_0 + y * w, deck])
        yield ("pallet", 2, deck), *from_above(rig, p, half)
    # Where an edge is so near that the forearm would hang straight down, the wrist is singular.
    for share in (0.04, 0.2):
        p = np.array([x_0, y_0 + share * w, deck - DEEP])
        yield ("pallet", 0, x_0), *from_side(p, np.array([1.0, 0.0, 0.0]), half)
    for share in (0.4, 0.95):
        p = np.array([x_0 + share * l, y_0 + w, deck - DEEP])
        yield ("pallet", 1, y_0 + w), *from_side(p, np.array([0.0, -1.0, 0.0]), half)
    table = cell.reorientation_table
    edge = table.centre[1] - 0.5 * table.size[1]
    for share in (-0.35, 0.35):
        p = np.array([table.centre[0] + share * table.size[0], edge, table.height - DEEP])
        yield ("reorientation_table", 1, edge), *from_side(p, np.array([0.0, 1.0, 0.0]), half)
    edge = table.centre[0] - 0.5 * table.size[0]
    p = np.array([edge, table.centre[1] - 0.3 * table.size[1], table.height - DEEP])
    yield ("reorientation_table", 0, edge), *from_side(p, np.array([1.0, 0.0, 0.0]), half)


def from_above(rig: CalibrationRig, p_W: Array, half: float) -> tuple[Pose, Array, Array]:
    """A tool whose corner away from the arm is lowest, over a point `(3,)` [m]."""
    outward = p_W[:2] - rig.arm.chain.points[0][:2]
    level = rotated_down(float(np.arctan2(outward[1], outward[0])) + 0.25 * np.pi)
    p_TC = np.array([half, half, 0.0])
    reach = rotate(level, p_TC)
    q_WT = multiply(exp(TILT * np.cross(reach, DOWN) / np.linalg.norm(reach)), level)
    return Pose(p_W - CLEAR * DOWN - rotate(q_WT, p_TC), q_WT), DOWN, p_TC


def from_side(p_W: Array, normal: Array, half: float) -> tuple[Pose, Array, Array]:
    """A tool that points down, with a corner of the pad ahead, beside a point of an edge `(3,)` [m]."""
    heading = float(np.arctan2(normal[1], normal[0]))
    # Looking down, the tool's y axis is turned over: its corner (h, h, 0) lies at -45 degrees of its x axis.
    q_WT = rotated_down(heading + 0.25 * np.pi)
    p_TC = np.array([half, half, 0.0])
    return Pose(p_W - CLEAR * normal - rotate(q_WT, p_TC), q_WT), normal, p_TC


def _over(rig: CalibrationRig, X_WT: Pose, normal: Array) -> None:
    """Come to an approach from above, and from outside where a side is touched."""
    aside = X_WT.p - (0.05 * normal if abs(normal[2]) < 0.5 else 0.0)
    rig.go(Pose(np.array([*aside[:2], max(aside[2] + 0.1, 0.35)]), X_WT.q))
    rig.line(Pose(aside, X_WT.q), 0.4)


def _away(rig: CalibrationRig) -> None:
    here = rig.tool()
    rig.line(Pose(here.p + np.array([0.0, 0.0, max(0.1, 0.9 - here.p[2])]), here.q), 0.6)


def _take_board(rig: CalibrationRig) -> Pose:
    """Grip the board, which the operator lays on the picking table, and return its nominal X_TB."""
    board, table = CALIBRATION_BOARD, rig.known.picking_table
    outward = np.array(table.centre) - rig.arm.chain.points[0][:2]
    yaw = float(np.arctan2(outward[1], outward[0]))  # the pattern lies beyond the handle, away from the arm
    X_WB = Pose(np.array([*table.centre, table.height + 0.5 * board.size[2]]), from_yaw(yaw))
    rig.bring(board.body, X_WB)
    # 4 mm for height and tilt of the table, which are not known yet; the pad reaches 10 mm.
    grip = Pose(X_WB.apply(board.p_handle) + np.array([0.0, 0.0, 0.004]), rotated_down(yaw))
    rig.go(Pose(grip.p + np.array([0.0, 0.0, 0.25]), grip.q))
    rig.line(grip, 0.1)
    X_TB = grip.inverse() @ X_WB
    rig.grip(CarriedBox(X_TB, np.array(board.size)))
    rig.line(Pose(grip.p + np.array([0.0, 0.0, 0.3]), grip.q), 0.25)
    rig.obstacles = furniture(rig.known)
    return X_TB


def _views(rig: CalibrationRig, X_TB: Pose) -> Iterator[Pose]:
    """Poses of the tool that show the board all over the part of the picture that is looked at."""
    table = rig.known.picking_table
    outward = np.array(table.centre) - rig.arm.chain.points[0][:2]
    yaw = float(np.arctan2(outward[1], outward[0]))
    middle_of_pattern = np.array([0.06, 0.0, 0.0])
    tilts = ((0.0, 0.0), (0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3), (0.2, 0.2), (-0.2, 0.2))
    k = 0
    for height in (0.15, 0.60):
        for x, y in PLACES_SEEN:
            tilt = tilts[k % len(tilts)]
            turn = 0.5 * np.sin(2.4 * k)
            k += 1
            q_WB = multiply(exp([*tilt, 0.0]), from_yaw(yaw + turn))
            p = np.array([table.centre[0] + x, table.centre[1] + y, table.height + height])
            X_WB = Pose(p - rotate(q_WB, middle_of_pattern), q_WB)
            yield X_WB @ X_TB.inverse()


def _lay_board_down(rig: CalibrationRig, X_TB: Pose) -> None:
    """Put the board back; the operator takes it away."""
    board, table = CALIBRATION_BOARD, rig.known.picking_table
    rig.obstacles = ()
    outward = np.array(table.centre) - rig.arm.chain.points[0][:2]
    yaw = float(np.arctan2(outward[1], outward[0]))
    X_WB = Pose(np.array([*table.centre, table.height + 0.5 * board.size[2] + 0.006]), from_yaw(yaw))
    X_WT = X_WB @ X_TB.inverse()
    rig.go(Pose(X_WT.p + np.array([0.0, 0.0, 0.25]), X_WT.q))
    rig.line(X_WT, 0.1)
    rig.release()
    rig.line(Pose(X_WT.p + np.array([0.0, 0.0, 0.2]), X_WT.q), 0.25)
    rig.take_away(board.name)
