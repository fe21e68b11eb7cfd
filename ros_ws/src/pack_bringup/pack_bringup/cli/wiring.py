"""`pack wiring`: what flows where."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from pack_bringup.wiring import COLUMNS, wiring_page, wiring_rows

app = typer.Typer()


@app.command()
def wiring(
    cell: Annotated[str, typer.Argument(help="Cell whose wiring is shown.")] = "packing",
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Write all cells as the page docs/dataflow.md.")
    ] = False,
) -> None:
    """List every topic, service and action of a cell, with who sends and who takes it.

    - `pack wiring packing`
    - `pack wiring --markdown > docs/dataflow.md`
    """
    from pack_core.ros.contracts.table import wiring_of, wiring_tables

    if markdown:
        typer.echo(wiring_page(wiring_tables()), nl=False)
        return
    table = Table(*COLUMNS)
    for row in wiring_rows(wiring_of(cell)):
        table.add_row(*row)
    Console().print(table)
