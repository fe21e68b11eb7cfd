"""What a calibration or its test found, as the action's result."""

from __future__ import annotations

import json

from pack_interfaces.action import CalibrateCell

from pallet_fsm.calibration.conclusion import CalibrationRun
from pallet_fsm.calibration.quick_check import Checked


def to_calibrated(run: CalibrationRun) -> CalibrateCell.Result:
    """The result of a calibration that is to be trusted."""
    calibration, found = run.calibration, run.found
    report = {
        "views": [
            {"pixels": view.pixels.tolist(), "off": off.tolist()}
            for view, off in zip(run.measured.views, found.views, strict=True)
        ],
        "touches": [
            {"name": contact.name, "off": float(off), "sigma": float(sigma)}
            for contact, off, sigma in zip(run.measured.contacts, found.contacts, found.expected, strict=True)
        ],
    }
    return CalibrateCell.Result(
        success=True, calibration=calibration.to_yaml(), predicted_mean=calibration.predicted.mean,
        predicted_p95=calibration.predicted.p95, execution_time=calibration.simulated_s,
        report=json.dumps(report),
    )  # fmt: skip


def to_checked(checked: Checked) -> CalibrateCell.Result:
    """The result of a test."""
    rows = [
        {"name": line.name, "off_mm": line.off_mm, "allowed_mm": line.allowed_mm} for line in checked.lines
    ]
    message = "" if checked.holds else f"{checked.worst}: calibrate again"
    return CalibrateCell.Result(
        success=checked.holds, message=message, execution_time=checked.seconds,
        report=json.dumps({"lines": rows}),
    )  # fmt: skip
