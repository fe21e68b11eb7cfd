"""`pack calibrate palletizing`: where everything in the cell is, how sure that is, shown and kept."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from pack_bringup.cli.calibrate import cells
from pack_bringup.cli.outputs import make_output_folder
from pack_bringup.cli.pursue import run_goal
from pack_bringup.cli.terminal import notice, show_table

if TYPE_CHECKING:
    from pack_bringup.cli.options import CellAddress
    from pack_core.palletizing.calibration import CellCalibration
    from pack_core.rotations import Array
    from pack_evaluation.palletizing.calibration_film import CalibrationFilm
    from pack_lockstep.palletizing.benchmark import PalletSetup

VIDEO = "calibration.mp4"


@cells.command()
def palletizing(
    seed: Annotated[int, typer.Option(min=0, help="Which of the simulated real cells.")] = 0,
    preset: Annotated[str, typer.Option(help="What the cell is like.")] = "real",
    check: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Only test whether this calibration still holds; takes a minute."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Folder for calibration.yaml and the plots."),
    ] = None,
    video: Annotated[bool, typer.Option(help="Render the calibration as MP4 (the slow part).")] = True,
) -> None:
    """Touch tables and pallet, show the board to the camera, and fit everything to it by least squares.

    The folder then holds calibration.yaml (estimates, uncertainties, the placing error to expect) and plots
    of the residuals, and calibration.mp4. The exit code is 2 if the residuals say that something is wrong,
    or if a check fails.

    - `pack calibrate palletizing --seed 3 --output /tmp/cell3`
    - `pack calibrate palletizing --seed 3 --check /tmp/cell3/calibration.yaml`
    """
    from pack_core.paths import bags_path
    from pack_lockstep.palletizing.settings import set_up

    setup = set_up(preset=preset)
    if check is not None:
        _check(setup, seed, check)
        return
    folder = output or bags_path() / "calibrations" / f"palletizing_{preset}_seed{seed}"
    make_output_folder(folder)
    show_calibration(calibrate_cell(setup, seed, folder, with_video=video), folder)


def calibrate_cell(
    setup: PalletSetup, seed: int, folder: Path, *, with_video: bool = False
) -> CellCalibration:
    """Calibrate the cell of a seed, with a line that says what is done; raises CalibrationFailed."""
    from rich.console import Console

    from pack_lockstep.palletizing.calibration_lockstep import calibrate as run
    from pack_lockstep.palletizing.calibration_log import CalibrationLog

    log = CalibrationLog(setup.config.period) if with_video else None
    with Console(stderr=True).status("calibrating") as line:
        found = run(setup.cell, setup.config, seed, lambda progress: line.update(progress.words), log)
    views = [(view.pixels, off) for view, off in zip(found.measured.views, found.found.views, strict=True)]
    touches = [
        (contact.name, off, sigma)
        for contact, off, sigma in zip(
            found.measured.contacts, found.found.contacts, found.found.expected, strict=True
        )
    ]
    write_result(found.calibration, views, touches, folder)
    if log is not None:
        _film(log.film(found), folder / VIDEO)
    return found.calibration


def _film(film: CalibrationFilm, path: Path) -> None:
    """Render the video, with a progress bar."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from pack_evaluation.palletizing.calibration_video import write_calibration_video

    with Progress(TextColumn("rendering"), BarColumn(), TimeRemainingColumn(), transient=True) as bar:
        task = bar.add_task("rendering", total=1.0)
        write_calibration_video(film, path, lambda done: bar.update(task, completed=done))


def _check(setup: PalletSetup, seed: int, file: Path) -> None:
    from pack_core.palletizing.calibration import load_calibration
    from pack_lockstep.palletizing.calibration_lockstep import quick_check

    checked = quick_check(setup.cell, setup.config, seed, load_calibration(file))
    lines = [(line.name, line.off_mm, line.allowed_mm) for line in checked.lines]
    show_check(lines, checked.seconds, holds=checked.holds)
    if not checked.holds:
        raise typer.Exit(2)


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
    from pack_lockstep.benchmarking.sources import digest

    if file is not None:
        known = known_cell(setup.cell.preset, str(file))
        assert known.calibration is not None
        calibrations = dict.fromkeys(seeds, known.calibration)
        return replace(setup, calibrations=calibrations, calibrated_by=f"a file, {digest(file)}")
    if not setup.cell.imperfections.uncalibrated_gap:
        return setup
    name = f"palletizing_{setup.name.replace(' ', '_')}"
    folder = (output or bags_path() / "benchmarks" / name) / FOLDER
    found = {seed: _of(setup, seed, folder, fresh=fresh) for seed in seeds}
    return replace(setup, calibrations=found, calibrated_by="its seed")


def _of(setup: PalletSetup, seed: int, folder: Path, *, fresh: bool) -> CellCalibration:
    """The calibration of one cell, from the folder or made now."""
    from pack_core.palletizing.calibration import load_calibration

    path = folder / f"seed{seed}" / "calibration.yaml"
    if path.is_file() and not fresh:
        return load_calibration(path)
    typer.echo(f"calibrating the cell of seed {seed}")
    return calibrate_cell(setup, seed, path.parent)


def send_calibration(
    check: bool, output: Path | None, seed: int, at: CellAddress, *, reset: bool
) -> NoReturn:
    """Have a running cell calibrate itself, or test its calibration, and leave as `run_goal` does."""
    from pack_bringup.palletizing.goals import CellCalibrationGoal
    from pack_core.paths import bags_path

    folder = output or bags_path() / "calibrations" / f"palletizing_{datetime.now():%Y%m%d_%H%M%S}"
    if not check:
        make_output_folder(folder)
    wanted = CellCalibrationGoal(check, seed)
    show = partial(show_action_result, folder=folder)
    run_goal(wanted, at, reset=reset, show=show)
