"""`pack calibrate palletizing`: where everything in the cell is, and how sure that is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.output_folder import make_output_folder
from pack_bringup.cli.terminal import notice, show_table

if TYPE_CHECKING:
    from pack_core.palletizing.calibration import CellCalibration
    from pack_lockstep.palletizing.benchmark import PalletSetup

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
) -> None:
    """Touch tables and pallet, show the board to the camera, and fit everything to it by least squares.

    The folder then holds calibration.yaml (estimates, uncertainties, the placing error to expect) and plots
    of the residuals. The exit code is 2 if the residuals say that something is wrong, or if a check fails.

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
    calibration = calibrate_cell(setup, seed, folder)
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
        f"{predicted.p95:.2f} mm in 95 of 100 cases; {folder / 'calibration.yaml'}"
    )


def calibrate_cell(setup: PalletSetup, seed: int, folder: Path) -> CellCalibration:
    """Calibrate the cell of a seed, with a line that says what is done; raises CalibrationFailed."""
    from rich.console import Console

    from pack_evaluation.palletizing.calibration_plots import write_calibration_plots
    from pack_lockstep.palletizing.calibration.calibrate import calibrate as run

    with Console(stderr=True).status("calibrating") as line:
        found = run(setup.cell, setup.config, seed, lambda text: line.update(text))
    found.calibration.write(folder / "calibration.yaml")
    write_calibration_plots(
        [(view.pixels, off) for view, off in zip(found.measured.views, found.found.views, strict=True)],
        [
            (f"{c.touch.what}, {'xyz'[c.touch.axis]}", off, sigma)
            for c, off, sigma in zip(
                found.measured.contacts, found.found.contacts, found.found.expected, strict=True
            )
        ],
        folder,
    )
    return found.calibration


def _check(setup: PalletSetup, seed: int, file: Path) -> None:
    from pack_core.palletizing.calibration import load_calibration
    from pack_lockstep.palletizing.calibration.quick_check import quick_check

    checked = quick_check(setup.cell, setup.config, seed, load_calibration(file))
    rows = [(line.name, f"{line.off_mm:.2f}", f"{line.allowed_mm:.2f}") for line in checked.lines]
    show_table(("what", "off [mm]", "allowed [mm]"), rows, title=f"Check, {checked.seconds:.0f} s simulated")
    if not checked.holds:
        notice("the calibration does not hold any more: calibrate again", typer.colors.RED, is_error=True)
        raise typer.Exit(2)
    notice("the calibration holds", typer.colors.GREEN)


def _readable(value: float, unit: str) -> tuple[str, str]:
    """A number and its unit as people read them."""
    scale, name = {"m": (1e3, "mm"), "rad": (1e3, "mrad")}.get(unit, (1.0, unit))
    return f"{scale * value:.3f}", name
