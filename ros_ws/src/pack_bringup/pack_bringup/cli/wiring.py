"""`pack wiring`: what flows where."""

from __future__ import annotations

from typing import Annotated

import typer

from pack_bringup.cli.terminal import show_table
from pack_bringup.wiring import COLUMNS, wiring_page, wiring_rows

app = typer.Typer()


@app.command()
def wiring(
    cell: Annotated[str, typer.Argument(help="Cell whose wiring is shown.")] = "packing",
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Write all cells as the page docs/reference/dataflow.md.")
    ] = False,
) -> None:
    """List every topic, service and action of a cell, with who sends and who takes it.

    - `pack wiring packing`
    - `pack wiring --markdown > docs/reference/dataflow.md`
    """
    from pack_core.ros.contracts.table import wiring_of, wiring_tables

    if markdown:
        typer.echo(wiring_page(wiring_tables()), nl=False)
        return
    show_table(COLUMNS, list(wiring_rows(wiring_of(cell))))
