"""What a calibration found, on the screen and in its folder."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from pack_bringup.cli.terminal import notice, show_table

if TYPE_CHECKING:
    from pack_core.palletizing.calibration import CellCalibration
    from pack_core.rotations import Array

FILE = "calibration.yaml"


def write_result(
    calibration: CellCalibration, views: Sequence[tuple[Array, Array]],
    touches: Sequence[tuple[str, float, float]], folder: Path,
) -> None:  # fmt: skip
    """Write the file and the plots of the residuals.

    Args:
        calibration: what was found.
        views: pixels of the corners of each view `(n, 2)`, and their residuals `(n, 2)` [pixel].
        touches: name, residual [m] and standard deviation [m] of each touch.
        folder: takes them.
    """
    from pack_evaluation.palletizing.calibration_plots import write_calibration_plots

    calibration.write(folder / FILE)
    write_calibration_plots(views, touches, folder)


def show_action_result(result: Any, folder: Path) -> None:
    """Show what a running cell has found, and write what is to be kept; nothing for a goal that failed."""
    if not result.report:
        return
    report = json.loads(result.report)
    if result.calibration:
        show_calibration(_written(result.calibration, report, folder), folder)
        return
    lines = [(line["name"], line["off_mm"], line["allowed_mm"]) for line in report["lines"]]
    show_check(lines, result.execution_time, holds=result.success)


def _written(text: str, report: dict[str, Any], folder: Path) -> CellCalibration:
    """The calibration of a file's text, written with the plots of its residuals."""
    import numpy as np

    from pack_core.palletizing.calibration import parse_calibration

    calibration = parse_calibration(text, "the result of /calibrate_cell")
    views = [(np.array(view["pixels"]), np.array(view["off"])) for view in report["views"]]
    touches = [(touch["name"], touch["off"], touch["sigma"]) for touch in report["touches"]]
    write_result(calibration, views, touches, folder)
    return calibration


def show_calibration(calibration: CellCalibration, folder: Path) -> None:
    """Show the estimates, the residuals, and the placing error to expect."""
    rows = [
        (e.name, *_readable(e.value, e.unit), _readable(e.sigma, e.unit)[0]) for e in calibration.estimates
    ]
    show_table(("what", "estimate", "unit", "standard deviation"), rows, title="Calibration")
    fits = [
        (r.name, str(r.count), f"{r.rms:.3g}", f"{r.expected:.3g}", r.unit) for r in calibration.residuals
    ]
    show_table(("residuals", "number", "rms", "expected", "unit"), fits)
    predicted = calibration.predicted
    typer.echo(
        f"{calibration.simulated_s:.0f} s simulated; boxes will be {predicted.mean:.2f} mm off on average, "
        f"{predicted.p95:.2f} mm in 95 of 100 cases; {folder / FILE}"
    )


def show_check(lines: Sequence[tuple[str, float, float]], seconds: float, *, holds: bool) -> None:
    """Show a test: name, distance and allowed distance [mm] of each line."""
    rows = [(name, f"{off:.2f}", f"{allowed:.2f}") for name, off, allowed in lines]
    show_table(("what", "off [mm]", "allowed [mm]"), rows, title=f"Check, {seconds:.0f} s simulated")
    if holds:
        notice("the calibration holds", typer.colors.GREEN)
    else:
        notice("the calibration does not hold any more: calibrate again", typer.colors.RED, is_error=True)


def _readable(value: float, unit: str) -> tuple[str, str]:
    """A number and its unit as people read them."""
    scale, name = {"m": (1e3, "mm"), "rad": (1e3, "mrad")}.get(unit, (1.0, unit))
    return f"{scale * value:.3f}", name
