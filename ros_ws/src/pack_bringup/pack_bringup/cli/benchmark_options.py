"""Options that the benchmarks of all cells have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Jobs = Annotated[
    int, typer.Option(min=1, help="Trials at a time, each in a process of its own on this machine.")
]
Ray = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Run the trials on a Ray cluster instead: its address, `auto` for the one that this machine is "
        "part of, `local` to start one here.",
    ),
]
Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="Folder of the results. Default: one below bags/benchmarks/, named after the settings.",
    ),
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Delete the results that DIR has already and measure anew.")
]
JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write the summary to this file, too.")
]
