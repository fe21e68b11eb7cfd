"""For drivers of arms: `pack robot`, the robot as files, and `pack driver check`, the contract."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.outputs import make_output_folder
from pack_core.cells import CELLS, cell_part
from pack_core.errors import ConfigError
from pack_core.paths import project_root

app = typer.Typer()
driver = typer.Typer(help="Drivers of arms that are not the simulator's.", no_args_is_help=True)
app.add_typer(driver, name="driver")


@driver.callback()
def _group() -> None:
    """Commands for whoever writes a driver."""


@driver.command()
def check(
    cell: Annotated[str, typer.Argument(help=f"The cell whose arm it drives: {', '.join(CELLS)}.")],
    command: Annotated[str, typer.Option(help="Starts the driver; it is ended by an interrupt.")] = "",
    domain: Annotated[int | None, typer.Option(help="ROS domain on which the driver runs already.")] = None,
    name: Annotated[str, typer.Option(help="Of its node, in /diagnostics and /alive.")] = "sim",
    action: Annotated[str, typer.Option(help="Its action for trajectories; empty: it takes setpoints.")] = "",
    only: Annotated[str, typer.Option(help="Names of tests, as `pytest -k` takes them.")] = "",
) -> None:
    """Run the contract tests against a driver. They MOVE a real arm: read docs/operate/driver.md first.

    - `pack driver check blocks --domain 7 --action /joint_trajectory_controller/follow_joint_trajectory`
    - `pack driver check palletizing --command "my_driver --arm kr210"`
    - `pack driver check packing --domain 7 --name my_driver --only "not beyond-limits"`
    """
    if cell not in CELLS:
        raise ConfigError(f"no cell '{cell}'; there are: {', '.join(CELLS)}")
    if bool(command) == (domain is not None):
        raise ConfigError("which driver? Give --command, which starts it, or --domain, on which it runs")
    running = ["--driver", command] if domain is None else ["--driver-domain", str(domain)]
    options = ["--driver-cell", cell, "--driver-name", name, *running]
    options += ["--driver-action", action] if action else []
    tests = "test_packing_driver.py" if cell == "packing" else "test_position_driver.py"
    pytest = [sys.executable, "-m", "pytest", "-v", f"tests/contract/{tests}", *options]
    raise typer.Exit(_wait_for([*pytest, *(["-k", only] if only else [])]))


def _wait_for(tests: list[str]) -> int:
    """The exit code of the tests, which end the driver that they have started before they end themselves.

    Ctrl-C reaches them without us, and SIGTERM is passed on as one: if we went before them a driver, and
    perhaps an arm, would be left to itself.
    """
    process = subprocess.Popen(tests, cwd=project_root())
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: process.send_signal(signal.SIGINT))
    return process.wait()


@app.command()
def robot(
    cell: Annotated[str, typer.Argument(help=f"Whose robot: {', '.join(CELLS)}.")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Where the files go.")],
    preset: Annotated[
        str, typer.Option(metavar="NAME", help="A preset with another arm: iiwa14 of packing.")
    ] = "",
) -> None:
    """Write a cell's robot as files for MoveIt and ros2_control (docs/operate/moveit.md).

    They are made from what the cell itself uses: a URDF, an SRDF, limits, solver and controllers for MoveIt,
    controllers for ros2_control, the URDF with hardware tags for a mock and for MuJoCo, and MuJoCo's model.

    - `pack robot palletizing --output kr210_description`
    - `pack robot packing --preset iiwa14 --output iiwa14_description`
    """
    from pack_bringup.graph.launch import launch_parameters

    made = cell_part(cell, "robot")(launch_parameters(cell, preset, ())["sim"])
    make_output_folder(output)
    for name, text in made.files().items():
        (output / name).write_text(text)
        typer.echo(output / name)
