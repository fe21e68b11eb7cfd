"""Options that the demos of all cells have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

RealTimeFactor = Annotated[
    float | None,
    typer.Option(
        min=0.0,
        help="Simulated seconds per second of wall clock; 0: as fast as possible. Default: see sim.yaml.",
    ),
]
Video = Annotated[
    bool, typer.Option(help="Render the run as MP4 and as an interactive replay, for the report.")
]
Domain = Annotated[
    int | None,
    typer.Option(min=0, max=101, help="ROS domain id. Default: the environment's, else one that is free."),
]
Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="Folder for everything that the run leaves behind. Default: a new one below bags/.",
    ),
]
