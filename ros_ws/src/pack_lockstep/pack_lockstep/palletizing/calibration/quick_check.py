"""A quick test whether a calibration still holds: put a box down and look, and touch the pallet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.box_body import BoxBody
from pack_core.palletizing.box_detection import ExpectedBox
from pack_core.palletizing.calibration import CellCalibration
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Array, Pose, from_yaw, multiply, yaw_of
from pack_lockstep.palletizing.calibration.measurements import contact_of
from pack_lockstep.palletizing.calibration.procedure import DOWN, TRAVEL, from_above
from pack_lockstep.palletizing.calibration.rig import CalibrationFailed, CalibrationRig, rotated_down
from pack_lockstep.palletizing.calibration.touch import touch
from pack_lockstep.palletizing.lockstep import PalletLockstepConfig
from pack_perception.boxes.box_vision import BoxVision
from pack_perception.boxes.table_camera import TableCamera
from pack_sim.palletizing.simulator import PalletSimulator

BOX = BoxBody("test box", (0.40, 0.30, 0.20), 8.0)
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


def quick_check(
    cell: PalletizingCell, config: PalletLockstepConfig, seed: int, calibration: CellCalibration
) -> Checked:
    """Test a calibration on the cell of a seed; raises CalibrationFailed when the arm or the box is stuck."""
    known = calibration.applied(cell)
    simulator = PalletSimulator(cell, config.simulator, seed, assumed=calibration.gears)
    with simulator.open_camera(config.sight.camera) as camera:
        rig = CalibrationRig(simulator, camera, known, config)
        seen_by = known.overhead_camera.scaled(config.sight.camera.width)
        eye = TableCamera(known, BoxVision(config.sight.vision), seen_by)
        lines = [*_touched(rig), *_seen(rig, eye)]
        return Checked(tuple(lines), rig.seconds)


def _touched(rig: CalibrationRig) -> list[CheckLine]:
    """Touch the deck of the pallet, and compare its height."""
    cell, half = rig.known, 0.5 * rig.known.tool.model_dump()["pad_size"]
    pallet = cell.pallet
    p = pallet.displaced(Pose(pallet.middle)).p
    X_WT, normal, p_TC = from_above(rig, p, half)
    rig.go(Pose(X_WT.p + np.array([0.0, 0.0, 0.15]), X_WT.q))
    recorded = touch(rig, X_WT, normal, TRAVEL, ("pallet", 2, pallet.deck_height), p_TC)
    contact = contact_of(recorded, rig.arm.chain, rig.period)
    p_WC = rig.arm.chain.with_tool(Pose(p_TC)).forward(contact.q).p
    off = pallet.displacement.about(pallet.middle).inverse().apply(p_WC)[2] - pallet.deck_height
    rig.line(Pose(X_WT.p + np.array([0.0, 0.0, 0.6]), X_WT.q), 0.6)
    return [CheckLine("height of the pallet's deck, touched", 1e3 * abs(float(off)), ALLOWED_TOUCH)]


def _seen(rig: CalibrationRig, eye: TableCamera) -> list[CheckLine]:
    """Grip a box where it is seen, put it elsewhere, and see whether it is there."""
    table, height = rig.known.picking_table, BOX.size[2]
    rig.bring(BOX, Pose(table.middle + np.array([0.0, 0.0, 0.5 * height])))
    X_WB = _look(rig, eye)
    lines = []
    for number, (x, y, yaw) in enumerate(PUTS, 1):
        level = Pose(table.middle + np.array([x, y, 0.5 * height]), from_yaw(yaw))
        asked = table.displaced(level)
        _carry(rig, X_WB, asked)
        X_WB = _look(rig, eye)
        off: Array = 1e3 * (X_WB.p - asked.p)[:2]
        lines.append(CheckLine(f"box put down and seen, {number}", float(np.linalg.norm(off)), ALLOWED_LOOK))
    rig.take_away(BOX.name)
    return lines


def _look(rig: CalibrationRig, eye: TableCamera) -> Pose:
    picture, _ = rig.look()
    found = eye.detect(picture, ExpectedBox(BOX.name, BOX.size, rig.seconds), rig.seconds).detection
    if found.X_WB is None:
        raise CalibrationFailed(f"the test box is not seen: {found.reason}")
    return found.X_WB


def _carry(rig: CalibrationRig, X_WB: Pose, asked: Pose) -> None:
    """Grip the box at X_WB, put it down where it is asked for, and leave."""
    rise = np.array([0.0, 0.0, 0.25])
    face = X_WB.apply(np.array([0.0, 0.0, 0.5 * BOX.size[2]]))
    grip = Pose(face + np.array([0.0, 0.0, 0.001]), rotated_down(yaw_of(X_WB.q)))
    rig.go(Pose(grip.p + rise, grip.q))
    rig.line(grip, 0.15)
    X_TB = rig.tool().inverse() @ X_WB
    rig.grip(CarriedBox(X_TB, np.array(BOX.size)))
    rig.line(Pose(grip.p + 0.6 * rise, grip.q), 0.2)
    X_WT = Pose(asked.p - 0.002 * DOWN, asked.q) @ X_TB.inverse()
    rig.go(Pose(X_WT.p + 0.6 * rise, X_WT.q))
    rig.line(X_WT, 0.08)
    rig.release()
    rig.line(Pose(X_WT.p + rise, X_WT.q), 0.25)
    aside = rig.known.pallet.displaced(Pose(rig.known.pallet.middle)).p + np.array([0.0, 0.0, 1.0])
    rig.go(Pose(aside, multiply(from_yaw(yaw_of(X_WT.q)), rotated_down(0.0))))
