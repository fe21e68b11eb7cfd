"""`pack layout`: where the boxes of an order would go, drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer()


@app.command()
def layout(
    order: Annotated[Path, typer.Argument(metavar="ORDER", help="An order file, e.g. of config/orders.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the pictures.")
    ] = Path("bags/layout"),
) -> None:
    """Plan the layout of an order and draw it: every layer with its gaps, and each box's way in.

    Nothing is simulated. The planner's parameters are those of config/nodes/palletizing/layout.yaml.

    - `pack layout config/orders/order_03.json --output /tmp/layout`
    """
    from pack_core.errors import OrderError
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.layout_plan import LayoutStatus
    from pack_core.palletizing.orders.order_file import load_order
    from pack_evaluation.palletizing.layout_drawing import write_pictures
    from pack_lockstep.node_parameters import load_parameters
    from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner

    given = load_order(order, palletizing_cell())
    plan = LayoutPlanner(load_parameters("palletizing/layout", LayoutConfig)).plan(given)
    if plan.status is not LayoutStatus.SUCCESS:
        raise OrderError(f"{order}: no layout: {plan.reason}")
    for path in write_pictures(given, plan, output):
        typer.echo(str(path))
