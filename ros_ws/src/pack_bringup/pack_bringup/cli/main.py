"""The `pack` command."""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from pack_bringup.cli import (
    bag,
    calibrate,
    cells,
    driver,
    evaluate,
    opcua,
    play,
    replay,
    results,
    run,
    status,
    stop,
    up,
    wiring,
)
from pack_bringup.cli.terminal import no_colours, notice
from pack_bringup.robustness import commands as robustness
from pack_core.cells import CELLS, optional_cell_part
from pack_core.errors import ConfigError, PackError
from pack_core.text.shown import on_one_line


class Commands(TyperGroup):
    """The commands of `pack`: a refused option says what was given and what is allowed."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command, whose options are read here."""
        try:
            return super().invoke(ctx)
        except typer.BadParameter as error:
            from pydantic import ValidationError

            from pack_core.text.explanation import allowed_words

            if isinstance(error.__cause__, ValidationError):
                item = error.__cause__.errors(include_url=False)[0]
                error.message = f"{on_one_line(str(item['input']))}; allowed: {allowed_words(item)}"
            raise


HELP_OPTIONS = {"help_option_names": ["-h", "--help"]}
app = typer.Typer(
    cls=Commands,
    context_settings=HELP_OPTIONS | ({"color": False} if no_colours() else {}),
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    help="""Run, record, measure and inspect PackCell's robot cells.

    - `pack demo packing` packs one object and reports; `pack demo palletizing`, `pack demo blocks` likewise
    - `pack evaluate BAG` measures a recorded run
    - `pack benchmark packing` measures many scenes, without ROS, on simulated time
    - `pack results` says which published figures are of this code
    - `pack order import items.csv --unit mm` makes orders for the palletizing cell
    - `pack replay BAG --node perception` feeds an algorithm what its node received, and compares
    - `pack play BAG` publishes a recording into the live graph
    - `pack up packing` starts a whole cell, each node a process
    - `pack goal packing` sends a goal to a cell that is running
    - `pack soak packing --hours 1` has a cell pursue goals for hours, and tells what grows
    - `pack status` says what runs, since when, and in which state
    - `pack stop` brakes the arm of a running cell at once; `pack resume` lets it go on
    - `pack run pack_sim sim_node` starts one node
    - `pack wiring` shows every topic, service and action
    - `pack driver check blocks --domain 7` says whether a driver of an arm does what the cell asks of it
    - `pack opcua palletizing` serves a running cell to a PLC
    - `pack robot palletizing --output DIR` writes its robot for MoveIt and ros2_control
    """,
)
for command in (
    cells,
    calibrate,
    evaluate,
    results,
    bag,
    replay,
    play,
    up,
    status,
    stop,
    run,
    robustness,
    wiring,
    driver,
    opcua,
):
    app.add_typer(command.app)
for cell in CELLS:
    for cells_own in optional_cell_part(cell, "commands") or ():
        app.add_typer(cells_own)


def _show_version(is_wanted: bool) -> None:
    if is_wanted:
        from pack_evaluation.provenance import checked_out_commit, project_version

        typer.echo(f"PackCell {project_version()}, commit {checked_out_commit()}")
        raise typer.Exit


def _check_opengl(backend: str) -> None:
    """Make sure that importing MuJoCo, which loads the backend, does not end in a library's traceback.

    With EGL, the usual one, this takes no time worth mentioning; MuJoCo is imported only with another one.

    Raises:
        ConfigError: it cannot be loaded.
    """
    try:
        if backend == "egl":
            ctypes.CDLL("libEGL.so.1")
        elif backend:
            import mujoco  # noqa: F401
    except Exception as error:  # whatever the bindings of the backend raise
        raise ConfigError(
            f"MUJOCO_GL is '{backend}', with which MuJoCo cannot be loaded: {error}; set MUJOCO_GL=egl, or "
            "install the library that it needs"
        ) from error


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", is_eager=True, callback=_show_version, help="Say which version and commit this is."
        ),
    ] = False,
) -> None:
    """Options in front of a command; those of `pack` itself end it."""
    _check_opengl(os.environ.get("MUJOCO_GL", ""))


def main() -> None:
    """Run the command line; a foreseeable error is one line and exit code 2."""
    try:
        app()
    except PackError as error:
        sys.exit(_shown(error))


def _shown(error: PackError) -> int:
    notice(f"error: {error}", typer.colors.RED, is_error=True)
    return 2
