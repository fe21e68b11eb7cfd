"""`pack executables`: what can be run."""

from __future__ import annotations

from typing import Annotated

import typer

from pack_bringup.graph.executables import executables_of, packages_with_executables

app = typer.Typer()


@app.command()
def executables(
    package: Annotated[str | None, typer.Argument(help="A package; all of them if not given.")] = None,
) -> None:
    """List what `pack run` can start, one `PACKAGE EXECUTABLE` a line."""
    for name in [package] if package else packages_with_executables():
        for path in executables_of(name):
            typer.echo(f"{name} {path.name}")
