"""What a calibration concludes from its measurements: it estimates, judges and predicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.calibration import CellCalibration, EstimatedNumber
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.imperfections import Displacement
from pack_core.robots.joint_properties import GearCompensation, Gears
from pallet_calibration.estimate import CalibrationFit, estimate
from pallet_calibration.model import CellModel
from pallet_calibration.parameters import (
    PARAMETERS,
    PLACE,
    PLACES,
    camera_of,
    gears_of,
)
from pallet_calibration.prediction import predict
from pallet_calibration.procedure import Measurements
from pallet_calibration.rig import CalibrationFailed

WORST_RATIO = 2.0
"""Residuals above this multiple of what is expected say that something is wrong: a thing that moved, a wrong
board, a gripper that slipped."""
FARTHEST = 4.0
"""So many standard deviations of what is known beforehand a thing may be from its nominal place."""


@dataclass(frozen=True)
class CalibrationRun:
    """What a calibration leaves: the file's content, and what it was found from."""

    calibration: CellCalibration
    found: CalibrationFit
    measured: Measurements


def conclude(
    cell: PalletizingCell, measured: Measurements, seconds: float, driver: GearCompensation | None = None
) -> CalibrationRun:
    """Estimate, judge and predict.

    Args:
        cell: the cell as its installer left it on paper.
        measured: everything that was measured.
        seconds: how long that took [s].
        driver: what the driver compensated meanwhile; by default the gears by their data sheet.

    Raises:
        CalibrationFailed: the residuals say that something is wrong.
    """
    model = model_of(cell, measured, driver)
    found = estimate(model, measured)
    if reasons := doubts(found):
        raise CalibrationFailed(
            "the calibration is not to be trusted: " + "; ".join(reasons) + ". Look for what moved or "
            "slipped, and calibrate again"
        )
    predicted = predict(model, found, np.random.default_rng(0))
    table_a, table_b, pallet = (Displacement.of(found.x[PLACE[name]]) for name in PLACES)
    sigmas = np.sqrt(np.diag(found.covariance))
    calibration = CellCalibration(
        preset=cell.preset, camera=camera_of(found.x),
        picking_table=table_a, reorientation_table=table_b, pallet=pallet,
        gears=gears_of(found.x, model.assumed, model.backlash_deg),
        predicted=predicted, simulated_s=seconds,
        estimates=tuple(
            EstimatedNumber(name=p.name, value=float(value), sigma=float(sigma), unit=p.unit)
            for p, value, sigma in zip(PARAMETERS, found.x, sigmas, strict=True)
        ),
        covariance=tuple(tuple(float(c) for c in row) for row in found.covariance),
        residuals=found.residuals(),
    )  # fmt: skip
    return CalibrationRun(calibration, found, measured)


def model_of(
    cell: PalletizingCell, measured: Measurements, driver: GearCompensation | None = None
) -> CellModel:
    """The model of what was measured; raises CalibrationFailed for a preset with rigid gears."""
    return CellModel(cell, arm_kinematics().chain, calibratable(cell).assumed, measured.X_TB, driver)


def calibratable(cell: PalletizingCell) -> Gears:
    """The gears of a cell that can be calibrated; raises CalibrationFailed for a preset without errors."""
    gears = cell.imperfections.gears
    if gears is None or not gears.reports_links or cell.imperfections.camera is None:
        raise CalibrationFailed(
            f"preset '{cell.preset}' has no errors of arm and camera to calibrate; `real` has them"
        )
    return gears


def doubts(found: CalibrationFit) -> list[str]:
    """Why the estimate should not be used; empty when nothing speaks against it."""
    reasons = [
        f"{line.name}: rms {line.rms:.3g} {line.unit}, expected {line.expected:.3g}"
        for line in found.residuals()
        if line.ratio > WORST_RATIO
    ]
    for parameter, value in zip(PARAMETERS, found.x, strict=True):
        if abs(value - parameter.value) > FARTHEST * parameter.sigma:
            far = f"{value:.4g} {parameter.unit}, far from {parameter.value:.4g}"
            reasons.append(f"{parameter.name} is {far}")
    return reasons
