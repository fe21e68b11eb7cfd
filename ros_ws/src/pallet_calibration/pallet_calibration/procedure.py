"""What the arm does during a calibration."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.rotations import Array, Pose, exp, from_yaw, multiply, rotate
from pack_core.tasks.steps import Steps
from pallet_calibration.measurements import BoardView, FeltContact, contact_of
from pallet_calibration.progress import Agenda, CalibrationState
from pallet_calibration.rig import CalibrationFailed, CalibrationRig
from pallet_calibration.touch import AXES, TRAVEL, rotated_down, touch, touches

PLACES_SEEN = (
    (0.0, 0.0), (0.4, 0.0), (-0.4, 0.0), (0.0, 0.35), (0.0, -0.35),
    (0.35, 0.3), (-0.35, -0.3), (-0.35, 0.3), (0.35, -0.3),
)  # fmt: skip
"""Where the pattern is shown, from the middle of the table [m]."""
HEIGHTS = (0.15, 0.60)
"""Of the pattern over the table [m]."""
FEWEST_VIEWS, FEWEST_CORNERS = 15, 20
"""Pictures of the board that the estimate needs, and corners in a picture that counts as one of it."""


@dataclass
class Measurements:
    """Everything that was measured."""

    contacts: list[FeltContact] = field(default_factory=list)
    views: list[BoardView] = field(default_factory=list)
    X_TB: Pose = field(default_factory=lambda: Pose(np.zeros(3)))
    """Nominal pose of the board in the gripper."""


def agenda_of(rig: CalibrationRig) -> Agenda:
    """What a calibration is made of."""
    return Agenda(
        {
            CalibrationState.TOUCH: sum(1 for _ in touches(rig)),
            CalibrationState.TAKE_BOARD: 1,
            CalibrationState.SHOW_BOARD: len(HEIGHTS) * len(PLACES_SEEN),
            CalibrationState.RETURN_BOARD: 1,
        }
    )


def measure(rig: CalibrationRig, agenda: Agenda) -> Steps[Measurements]:
    """Touch tables and pallet, then show the board to the camera; raises CalibrationFailed."""
    found = Measurements()
    rig.obstacles = ()  # near surfaces that are to be touched no clearance can be asked for
    for surface, X_WT, normal, p_TC in touches(rig):
        what = f"{surface[0].replace('_', ' ')}, {AXES[surface[1]]}"
        agenda.begin(CalibrationState.TOUCH, what, rig.seen.time)
        yield from _over(rig, X_WT, normal)
        recorded = yield from touch(rig, X_WT, normal, TRAVEL, surface, p_TC)
        found.contacts.append(contact_of(recorded, rig.arm.chain, rig.period))
        yield from _away(rig)
    agenda.begin(CalibrationState.TAKE_BOARD, "", rig.seen.time)
    found.X_TB = yield from _take_board(rig)
    for X_WT in _views(rig, found.X_TB):
        agenda.begin(CalibrationState.SHOW_BOARD, f"{len(found.views)} seen", rig.seen.time)
        yield from _show(rig, X_WT, found.views)
    if len(found.views) < FEWEST_VIEWS:
        raise CalibrationFailed(
            f"the board was seen in {len(found.views)} pictures; needed: {FEWEST_VIEWS}. Is it in the light?"
        )
    agenda.begin(CalibrationState.RETURN_BOARD, "", rig.seen.time)
    yield from _lay_board_down(rig, found.X_TB)
    return found


def _show(rig: CalibrationRig, X_WT: Pose, views: list[BoardView]) -> Steps[None]:
    """Show the board at a pose, and add what is seen of it to the views."""
    try:
        yield from rig.go(X_WT)
    except CalibrationFailed:
        return  # out of reach, or too near to something: the others are enough
    sample = yield from rig.take_picture(CALIBRATION_BOARD.body)
    sighting = rig.seen.sighting
    if sighting is not None and len(sighting.ids) >= FEWEST_CORNERS:
        pixels = sighting.scaled(rig.known.overhead_camera.width).pixels
        views.append(BoardView(sample.q, sighting.ids, pixels))


def _over(rig: CalibrationRig, X_WT: Pose, normal: Array) -> Steps[None]:
    """Come to an approach from above, and from outside where a side is touched."""
    aside = X_WT.p - (0.05 * normal if abs(normal[2]) < 0.5 else 0.0)
    yield from rig.go(Pose(np.array([*aside[:2], max(aside[2] + 0.1, 0.35)]), X_WT.q))
    yield from rig.line(Pose(aside, X_WT.q), 0.4)


def _away(rig: CalibrationRig) -> Steps[None]:
    here = rig.tool()
    yield from rig.line(Pose(here.p + np.array([0.0, 0.0, max(0.1, 0.9 - here.p[2])]), here.q), 0.6)


def _take_board(rig: CalibrationRig) -> Steps[Pose]:
    """Grip the board, which the operator lays on the picking table, and return its nominal X_TB."""
    board, table = CALIBRATION_BOARD, rig.known.picking_table
    outward = np.array(table.centre) - rig.arm.chain.points[0][:2]
    yaw = float(np.arctan2(outward[1], outward[0]))  # the pattern lies beyond the handle, away from the arm
    X_WB = Pose(np.array([*table.centre, table.height + 0.5 * board.size[2]]), from_yaw(yaw))
    yield from rig.bring(board.body, X_WB)
    # 4 mm for height and tilt of the table, which are not known yet; the pad reaches 10 mm.
    grip = Pose(X_WB.apply(board.p_handle) + np.array([0.0, 0.0, 0.004]), rotated_down(yaw))
    yield from rig.go(Pose(grip.p + np.array([0.0, 0.0, 0.25]), grip.q))
    yield from rig.line(grip, 0.1)
    X_TB = grip.inverse() @ X_WB
    yield from rig.grip(CarriedBox(X_TB, np.array(board.size)))
    yield from rig.line(Pose(grip.p + np.array([0.0, 0.0, 0.3]), grip.q), 0.25)
    rig.obstacles = rig.known.furniture
    return X_TB


def _views(rig: CalibrationRig, X_TB: Pose) -> Iterator[Pose]:
    """Poses of the tool that show the board all over the part of the picture that is looked at."""
    table = rig.known.picking_table
    outward = np.array(table.centre) - rig.arm.chain.points[0][:2]
    yaw = float(np.arctan2(outward[1], outward[0]))
    middle_of_pattern = np.array([0.06, 0.0, 0.0])
    tilts = ((0.0, 0.0), (0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3), (0.2, 0.2), (-0.2, 0.2))
    k = 0
    for height in HEIGHTS:
        for x, y in PLACES_SEEN:
            tilt = tilts[k % len(tilts)]
            turn = 0.5 * np.sin(2.4 * k)
            k += 1
            q_WB = multiply(exp([*tilt, 0.0]), from_yaw(yaw + turn))
            p = np.array([table.centre[0] + x, table.centre[1] + y, table.height + height])
            X_WB = Pose(p - rotate(q_WB, middle_of_pattern), q_WB)
            yield X_WB @ X_TB.inverse()


def _lay_board_down(rig: CalibrationRig, X_TB: Pose) -> Steps[None]:
    """Put the board back; the operator takes it away."""
    board, table = CALIBRATION_BOARD, rig.known.picking_table
    rig.obstacles = ()
    outward = np.array(table.centre) - rig.arm.chain.points[0][:2]
    yaw = float(np.arctan2(outward[1], outward[0]))
    X_WB = Pose(np.array([*table.centre, table.height + 0.5 * board.size[2] + 0.006]), from_yaw(yaw))
    X_WT = X_WB @ X_TB.inverse()
    yield from rig.go(Pose(X_WT.p + np.array([0.0, 0.0, 0.25]), X_WT.q))
    yield from rig.line(X_WT, 0.1)
    yield from rig.release()
    yield from rig.line(Pose(X_WT.p + np.array([0.0, 0.0, 0.2]), X_WT.q), 0.25)
    rig.take_away(board.name)
