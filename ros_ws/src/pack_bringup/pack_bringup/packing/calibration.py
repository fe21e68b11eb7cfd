"""`pack calibrate packing`: where the depth cameras hang, how sure that is, shown and kept."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.calibrate import cells
from pack_bringup.cli.outputs import make_output_folder
from pack_bringup.cli.terminal import notice, show_table
from pack_core.errors import ConfigError

if TYPE_CHECKING:
    from pack_core.packing.cell import PackingCell
    from pack_core.packing.depth_calibration import DepthCalibration
    from pack_lockstep.packing.camera_calibration import CameraCalibration
    from pack_lockstep.packing.lockstep_config import LockstepConfig

FILE = "calibration.yaml"


@cells.command()
def packing(
    seed: Annotated[
        int, typer.Option(min=0, help="Which of the simulated cells: where its cameras truly hang.")
    ] = 0,
    preset: Annotated[str, typer.Option(help="What the cell is like: one with depth cameras.")] = "installed",
    check: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Only test whether this calibration still holds."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="DIR", help="Folder for calibration.yaml.")
    ] = None,
) -> None:
    """Find out where the depth cameras hang, by the arm's own pump at 14 postures over the container.

    The arm holds nothing, and nothing else is needed: the pump's shape is known, and where it is follows from
    the joints. Each camera's pose is fitted until what it measures of the pump lies on the pump. The folder
    then holds calibration.yaml (poses, standard deviations, residuals), which nodes are started with:

    - `pack calibrate packing --seed 3 --output /tmp/cell3`
    - `pack calibrate packing --seed 3 --check /tmp/cell3/calibration.yaml`
    - `pack up packing --preset installed --set sim.seed=3 --calibration /tmp/cell3/calibration.yaml`

    The exit code is 2 if a camera sees too little of the pump, if it was knocked meanwhile, if it hangs more
    than 30 mm or 3 degrees from where it is described, or if a check fails.
    """
    from pack_core.packing.cell import Perception
    from pack_core.paths import bags_path
    from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config

    given = load_preset(preset)
    cell, config = given.packing_cell(), lockstep_config(given)
    if cell.perception is not Perception.DEPTH:
        raise ConfigError(
            f"preset '{preset}' has no depth cameras to calibrate; allowed: depth, installed, unknown and "
            "others with `perception: depth`"
        )
    if check is not None:
        _check(cell, config, seed, check)
        return
    folder = output or bags_path() / "calibrations" / f"packing_{preset}_seed{seed}"
    make_output_folder(folder)
    _calibrate(cell, config, seed, preset, folder / FILE)


def _calibrate(cell: PackingCell, config: LockstepConfig, seed: int, preset: str, path: Path) -> None:
    """Calibrate the cell of a seed, with a line that says what is done; raises CameraCalibrationFailed."""
    from rich.console import Console

    from pack_lockstep.packing.camera_calibration import calibrate

    with Console(stderr=True).status("calibrating") as line:
        found = calibrate(cell, config, seed, lambda n, of: line.update(f"{n} of {of} postures seen"))
    file = found.file(cell, preset)
    file.write(path)
    _show(file, found, path)


def _show(file: DepthCalibration, found: CameraCalibration, path: Path) -> None:
    rows = [
        (
            camera.name,
            f"{1e3 * math.hypot(*camera.shift):.1f} mm, {math.degrees(math.hypot(*camera.turn)):.2f} deg",
            f"{1e3 * camera.sigma_shift:.2f} mm, {math.degrees(camera.sigma_turn):.3f} deg",
            f"{1e3 * camera.residual:.2f} mm", str(camera.postures),
        )
        for camera in file.cameras
    ]  # fmt: skip
    show_table(
        ("camera", "off at the container", "standard deviation", "residual, rms", "postures"), rows,
        title="Calibration",
    )  # fmt: skip
    for camera, seen in zip(file.cameras, found.container, strict=True):
        if seen is not None:
            shift, turn = math.hypot(*seen.shift), math.degrees(math.hypot(*seen.turn))
            typer.echo(
                f"{camera.name}, as calibrated, sees the container {1e3 * shift:.1f} mm and {turn:.2f} "
                "degrees off its place"
            )
    typer.echo(f"{file.simulated_s:.0f} s simulated; {path}")


def _check(cell: PackingCell, config: LockstepConfig, seed: int, file: Path) -> None:
    from rich.console import Console

    from pack_core.packing.depth_calibration import load_depth_calibration
    from pack_lockstep.packing.camera_calibration import CHECK_SHIFT, CHECK_TURN, check

    calibration = load_depth_calibration(file)
    with Console(stderr=True).status("checking") as line:
        checked = check(
            cell, config, seed, calibration, lambda n, of: line.update(f"{n} of {of} postures seen")
        )
    rows = [(c.name, f"{1e3 * c.shift:.2f}", f"{math.degrees(c.turn):.3f}") for c in checked]
    rows.append(("allowed", f"{1e3 * CHECK_SHIFT:.2f}", f"{math.degrees(CHECK_TURN):.3f}"))
    show_table(("camera", "off [mm]", "turned [deg]"), rows, title="Check")
    if all(camera.holds for camera in checked):
        notice("the calibration holds", typer.colors.GREEN)
        return
    notice("the calibration does not hold any more: calibrate again", typer.colors.RED, is_error=True)
    raise typer.Exit(2)
