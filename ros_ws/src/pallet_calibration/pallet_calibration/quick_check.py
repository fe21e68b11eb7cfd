"""A quick test whether a calibration still holds: put a box down and look, and touch the pallet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.boxes import BoxBody
from pack_core.rotations import Array, Pose, from_yaw, multiply, yaw_of
from pack_core.tasks.steps import Steps
from pallet_calibration.measurements import contact_of
from pallet_calibration.progress import Agenda, CalibrationState
from pallet_calibration.rig import CalibrationFailed, CalibrationRig
from pallet_calibration.touch import DOWN, TRAVEL, from_above, rotated_down, touch

BOX = BoxBody("test box", (0.40, 0.30, 0.20), 8.0)
"""An ordinary box: edges [m] and mass [kg]."""
PUTS = ((0.05, 0.05, np.pi), (-0.05, -0.05, 1.5 * np.pi))
"""Where the box is put down: x and y from the middle of the table [m], yaw [rad]. It is turned by half a turn
and a quarter: one that is not turned comes out right with a camera that sees all too far to one side."""
ALLOWED_LOOK, ALLOWED_TOUCH = 1.0, 0.5
"""Largest distances with which the calibration still holds [mm]: a third of the cell's largest placing error,
and a quarter of the height from which boxes are let go."""


@dataclass(frozen=True)
class CheckLine:
    """One thing that was tested: how far it is from where it should be, and how far it may be [mm]."""

    name: str
    off_mm: float
    allowed_mm: float


@dataclass(frozen=True)
class Checked:
    """The result of a test, which took simulated `seconds`."""

    lines: tuple[CheckLine, ...]
    seconds: float

    @property
    def holds(self) -> bool:
        """Whether the calibration still holds."""
        return all(line.off_mm <= line.allowed_mm for line in self.lines)

    @property
    def worst(self) -> str:
        """The line that is farthest beyond what is allowed, in words."""
        line = max(self.lines, key=lambda line: line.off_mm / line.allowed_mm)
        return f"{line.name}: {line.off_mm:.2f} mm off, allowed {line.allowed_mm:.2f}"


def check_agenda() -> Agenda:
    """What a check is made of."""
    return Agenda(
        {
            CalibrationState.TOUCH_DECK: 1,
            CalibrationState.TAKE_BOX: 1,
            CalibrationState.MOVE_BOX: len(PUTS),
        }
    )


def check(rig: CalibrationRig, agenda: Agenda) -> Steps[tuple[CheckLine, ...]]:
    """Test the calibration by which the rig knows its cell; raises CalibrationFailed."""
    agenda.begin(CalibrationState.TOUCH_DECK, "", rig.seen.time)
    deck = yield from _touched(rig)
    agenda.begin(CalibrationState.TAKE_BOX, "", rig.seen.time)
    table, height = rig.known.picking_table, BOX.size[2]
    yield from rig.bring(BOX, Pose(table.middle + np.array([0.0, 0.0, 0.5 * height])))
    X_WB = yield from _look(rig)
    lines = [deck]
    for number, (x, y, yaw) in enumerate(PUTS, 1):
        agenda.begin(CalibrationState.MOVE_BOX, "", rig.seen.time)
        level = Pose(table.middle + np.array([x, y, 0.5 * height]), from_yaw(yaw))
        asked = table.displaced(level)
        yield from _carry(rig, X_WB, asked)
        X_WB = yield from _look(rig)
        off: Array = 1e3 * (X_WB.p - asked.p)[:2]
        lines.append(CheckLine(f"box put down and seen, {number}", float(np.linalg.norm(off)), ALLOWED_LOOK))
    rig.take_away(BOX.name)
    return tuple(lines)


def _touched(rig: CalibrationRig) -> Steps[CheckLine]:
    """Touch the deck of the pallet, and compare its height."""
    cell, half = rig.known, 0.5 * rig.known.tool.model_dump()["pad_size"]
    pallet = cell.pallet
    p = pallet.displaced(Pose(pallet.middle)).p
    X_WT, normal, p_TC = from_above(rig, p, half)
    yield from rig.go(Pose(X_WT.p + np.array([0.0, 0.0, 0.15]), X_WT.q))
    recorded = yield from touch(rig, X_WT, normal, TRAVEL, ("pallet", 2, pallet.deck_height), p_TC)
    contact = contact_of(recorded, rig.arm.chain, rig.period)
    p_WC = rig.arm.chain.with_tool(Pose(p_TC)).forward(contact.q).p
    off = pallet.displacement.about(pallet.middle).inverse().apply(p_WC)[2] - pallet.deck_height
    yield from rig.line(Pose(X_WT.p + np.array([0.0, 0.0, 0.6]), X_WT.q), 0.6)
    return CheckLine("height of the pallet's deck, touched", 1e3 * abs(float(off)), ALLOWED_TOUCH)


def _look(rig: CalibrationRig) -> Steps[Pose]:
    """X_WB of the test box, as box vision sees it."""
    yield from rig.take_picture(BOX)
    found = rig.seen.detection
    if found is None or found.X_WB is None:
        reason = "" if found is None else found.reason
        raise CalibrationFailed(f"the test box is not seen: {reason}")
    return found.X_WB


def _carry(rig: CalibrationRig, X_WB: Pose, asked: Pose) -> Steps[None]:
    """Grip the box at X_WB, put it down where it is asked for, and leave."""
    rise = np.array([0.0, 0.0, 0.25])
    face = X_WB.apply(np.array([0.0, 0.0, 0.5 * BOX.size[2]]))
    grip = Pose(face + np.array([0.0, 0.0, 0.001]), rotated_down(yaw_of(X_WB.q)))
    yield from rig.go(Pose(grip.p + rise, grip.q))
    yield from rig.line(grip, 0.15)
    X_TB = rig.tool().inverse() @ X_WB
    yield from rig.grip(CarriedBox(X_TB, np.array(BOX.size)))
    yield from rig.line(Pose(grip.p + 0.6 * rise, grip.q), 0.2)
    X_WT = Pose(asked.p - 0.002 * DOWN, asked.q) @ X_TB.inverse()
    yield from rig.go(Pose(X_WT.p + 0.6 * rise, X_WT.q))
    yield from rig.line(X_WT, 0.08)
    yield from rig.release()
    yield from rig.line(Pose(X_WT.p + rise, X_WT.q), 0.25)
    aside = rig.known.pallet.displaced(Pose(rig.known.pallet.middle)).p + np.array([0.0, 0.0, 1.0])
    yield from rig.go(Pose(aside, multiply(from_yaw(yaw_of(X_WT.q)), rotated_down(0.0))))
