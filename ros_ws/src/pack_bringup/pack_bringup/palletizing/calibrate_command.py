"""`pack calibrate palletizing`: where everything in the cell is, and how sure that is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.output_folder import make_output_folder
from pack_bringup.palletizing.calibration_result import show_calibration, show_check, write_result

if TYPE_CHECKING:
    from pack_core.palletizing.calibration import CellCalibration
    from pack_evaluation.palletizing.calibration_film import CalibrationFilm
    from pack_lockstep.palletizing.benchmark import PalletSetup

VIDEO = "calibration.mp4"
app = typer.Typer()
cells = typer.Typer(no_args_is_help=True, help="Find out where everything in a cell is, with what it has.")
app.add_typer(cells, name="calibrate")


@cells.callback()
def calibrate() -> None:
    """Calibrate a cell."""


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

    setup = set_up(profile="blended", motion="shipped", preset=preset, vision=True)
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
