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
    markdown: Annotated[bool, typer.Option("--markdown", help="The text of docs/dataflow.md.")] = False,
) -> None:
    """List every topic, service and action of the packing cell, with who sends and who takes it.

    - `pack wiring`
    - `pack wiring --markdown > docs/dataflow.md`
    """
    from pack_core.ros.contracts import CONTRACTS

    if markdown:
        typer.echo(wiring_page(CONTRACTS), nl=False)
        return
    table = Table(*COLUMNS)
    for row in wiring_rows(CONTRACTS):
        table.add_row(*row)
    Console().print(table)
