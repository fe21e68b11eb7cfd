"""`pack states`: the palletizing machine, drawn."""

from __future__ import annotations

import typer

app = typer.Typer()


@app.command()
def states() -> None:
    """Show the states of the palletizing cell and what leads from one to the next, as Markdown.

    - `pack states > docs/cells/palletizing/states.md`
    """
    from pallet_fsm.drawing import states_page

    typer.echo(states_page(), nl=False)
