"""Calibrations of the cells of a benchmark: read from a file, kept from an earlier run, or made now."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from pack_core.palletizing.calibration import CellCalibration
    from pack_lockstep.palletizing.benchmark import PalletSetup

FOLDER = "calibrations"


def calibrations_for(
    setup: PalletSetup, seeds: Iterable[int], file: Path | None, output: Path | None, *, fresh: bool
) -> PalletSetup:
    """The setup with a calibration for every seed; as it is where the preset asks for none.

    Args:
        setup: the benchmark's setup.
        seeds: the cells.
        file: one calibration for all of them.
        output: the benchmark's folder; calibrations are kept there in `calibrations`.
        fresh: calibrate anew what was calibrated before.

    Raises:
        ConfigError: the file cannot be read, or is of another preset.
        CalibrationFailed: a cell cannot be calibrated.
    """
    from pack_core.palletizing.calibration import known_cell
    from pack_core.paths import bags_path

    if file is not None:
        known = known_cell(setup.cell.preset, str(file))
        assert known.calibration is not None
        return replace(setup, calibrations=dict.fromkeys(seeds, known.calibration))
    if not setup.cell.imperfections.uncalibrated_gap:
        return setup
    name = f"palletizing_{setup.name.replace(' ', '_')}"
    folder = (output or bags_path() / "benchmarks" / name) / FOLDER
    return replace(setup, calibrations={seed: _of(setup, seed, folder, fresh=fresh) for seed in seeds})


def _of(setup: PalletSetup, seed: int, folder: Path, *, fresh: bool) -> CellCalibration:
    """The calibration of one cell, from the folder or made now."""
    from pack_bringup.palletizing.calibrate_command import calibrate_cell
    from pack_core.palletizing.calibration import load_calibration

    path = folder / f"seed{seed}" / "calibration.yaml"
    if path.is_file() and not fresh:
        return load_calibration(path)
    typer.echo(f"calibrating the cell of seed {seed}")
    return calibrate_cell(setup, seed, path.parent)
