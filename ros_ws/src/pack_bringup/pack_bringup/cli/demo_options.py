"""Options that the demos of all cells have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

RealTimeFactor = Annotated[
    float | None,
    typer.Option(
        min=0.0,
        help="Simulated seconds a second; 0: as fast as it can. Default: that of the cell's sim.yaml.",
    ),
]
Video = Annotated[bool, typer.Option(help="Render the run as MP4.")]
Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="The run's folder; one below bags/ if not given."),
]
