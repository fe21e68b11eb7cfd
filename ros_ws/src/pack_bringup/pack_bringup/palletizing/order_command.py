"""`pack order`: check orders, and make them from lists of items."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.outputs import make_output_folder
from pack_bringup.cli.terminal import notice, show_table

if TYPE_CHECKING:
    from pack_core.palletizing.orders.item_list import Unit
    from pack_lockstep.palletizing.proposal import Proposal, Proposals

app = typer.Typer()
order_app = typer.Typer(no_args_is_help=True, help="Check orders, and make them from lists of items.")
app.add_typer(order_app, name="order")

Pictures = Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for pictures.")]


@order_app.command()
def check(
    order: Annotated[Path, typer.Argument(metavar="FILE", help="An order file, e.g. of config/orders.")],
    output: Pictures = Path("bags/orders"),
) -> None:
    """Say whether the cell can build an order, with every reason if not, and draw it.

    Checked are keys and values, overlaps, support and what boxes carry (max_load, max_pressure), the
    gripper's limits, the layout with gaps, and, in physics, whether the finished stack stands when it is
    pushed with 0.2 g along each side. Which box tips first is told by the closed rule. Boxes that
    something is wrong with are red in the picture. The exit code is 0 if there is no reason against it.

    - `pack order check config/orders/order_03.json`
    - `pack order check config/orders/stress/order_01.json --output /tmp/orders`
    """
    make_output_folder(output)
    from pack_core.errors import ConfigError, OrderError
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import order_as_written
    from pack_core.palletizing.orders.tipping import pushes_of
    from pack_core.text.reader import read_text
    from pack_evaluation.palletizing.drawings import draw_order, write_pictures
    from pack_lockstep.node_parameters import load_parameters
    from pack_lockstep.palletizing.proposal import judge
    from pack_planner.layout.layout_planner import LayoutConfig

    try:
        given = order_as_written(read_text(order), str(order))
    except ConfigError as error:
        raise OrderError(str(error)) from error
    reasons, plan, hold_mm = judge(
        given, palletizing_cell(), load_parameters("palletizing/layout", LayoutConfig)
    )
    picture = output / f"{order.stem}_check.png"
    draw_order(given, reasons).savefig(picture, dpi=110)
    for reason in reasons:
        notice(f"{order}: {reason}", typer.colors.RED)
    if plan is not None:
        box, push = min(pushes_of([item.placed for item in plan.boxes]).items(), key=lambda item: item[1])
        typer.echo(f"by the closed rule box '{box}' tips first, with all that it carries, at {push:.2f} g")
    if hold_mm is not None:
        typer.echo(f"largest shift of a box under 0.2 g: {hold_mm:.1f} mm")
    pictures = [picture, *(write_pictures(given, plan, output)[:1] if plan is not None else [])]
    for path in pictures:
        typer.echo(str(path))
    if reasons:
        raise typer.Exit(1)
    notice(f"{order}: {len(given.boxes)} boxes, can be built", typer.colors.GREEN)


@order_app.command(name="import")
def import_items(
    items: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Lists of items, .csv or .json, or orders.")
    ],
    name: Annotated[str, typer.Option(help="Id of the order. Default: the list's file name.")] = "",
    unit: Annotated[str, typer.Option(help="Unit of all lengths in the list: m, cm or mm.")] = "m",
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for orders and pictures.")
    ] = Path("bags/orders"),
    sort: Annotated[
        bool,
        typer.Option(
            "--sort/--as-listed",
            help="Let boxes arrive in whatever sequence packs best, or in that of the list.",
        ),
    ] = True,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random sequences that are tried.")] = 0,
) -> None:
    """Make an order, or as many as are needed, from a list of items: sizes, weights, quantities.

    The columns are article, length, width, height, weight [kg], and, if wanted, quantity, this_side_up (yes:
    the height stays upright), max_load [kg], max_pressure [kPa] and stackable (no: nothing may stand on it).
    JSON is a list of objects with the same names; of an order's file the boxes are taken, without their
    places. Every order that is written passes `pack order check`. Items that are in none of them are named
    with the reasons in ID_left.txt beside the orders, and the exit code is 1.

    - `pack order import items.csv --unit mm`
    - `pack order import items.json --name my-order --as-listed --output /tmp/orders`
    """
    from typer import BadParameter

    from pack_core.palletizing.orders.item_list import METRES, load_items

    if unit not in METRES:
        raise BadParameter(f"{unit}; allowed: {', '.join(METRES)}", param_hint="--unit")
    listed_unit: Unit = unit  # type: ignore[assignment]  # one of the three, as was just checked
    if name and len(items) > 1:
        raise BadParameter(
            "allowed: with one list; each of several gets its file's name", param_hint="--name"
        )
    names = order_names(items, name)
    lists = {order_id: load_items(path, listed_unit) for order_id, path in names.items()}
    make_output_folder(output)

    # What follows takes a second to import: what is wrong with a list is said before.
    from rich.console import Console

    from pack_core.palletizing.cell import palletizing_cell
    from pack_evaluation.palletizing.drawings import draw_order
    from pack_lockstep.node_parameters import load_parameters
    from pack_lockstep.palletizing.proposal import propose
    from pack_planner.layout.layout_planner import LayoutConfig
    from pack_planner.layout.order_proposal import ProposalConfig

    layout = load_parameters("palletizing/layout", LayoutConfig)
    config = ProposalConfig(seed=seed, may_sort=sort)
    found: list[Proposal] = []
    left: dict[str, Proposals] = {}
    with Console(stderr=True).status("packing") as line:
        for order_id, boxes in lists.items():
            proposals = propose(boxes, order_id, palletizing_cell(), config, layout, line.update)
            found += proposals.pallets
            if proposals.reasons:
                left[order_id] = proposals
    for proposal in found:
        path = output / f"{proposal.order.order_id}.json"
        path.write_text(proposal.order.model_dump_json(indent=1, exclude_none=True) + "\n")
        draw_order(proposal.order, []).savefig(path.with_suffix(".png"), dpi=110)
    if found:
        _show(found, output)
    for order_id, proposals in left.items():
        _show_left(output / f"{order_id}_left.txt", proposals)
    if any(proposals.left for proposals in left.values()):
        raise typer.Exit(1)


def order_names(lists: list[Path], name: str = "") -> dict[str, Path]:
    """The id of each list's order: its file's name, or `name`; further pallets have a number behind it.

    Raises:
        OrderError: a name may be no id, or two lists would lead to orders of one name.
    """
    from pydantic import TypeAdapter, ValidationError

    from pack_core.errors import OrderError
    from pack_core.text.limits import MOST_CHARACTERS_OF_NAME, ArticleName
    from pack_core.text.shown import shown_value

    found: dict[str, Path] = {}
    for path in lists:
        order_id = name or path.stem
        try:
            TypeAdapter(ArticleName).validate_python(order_id.replace("/", "\0"))  # it becomes a file's name
        except ValidationError as error:
            raise OrderError(
                f"{path}: its order would be called {shown_value(order_id)}; allowed: a letter or digit "
                f"first, then letters, digits, spaces and any of .:+#()@,=- up to {MOST_CHARACTERS_OF_NAME} "
                "characters; --name gives it another"
            ) from error
        if order_id in found:
            raise OrderError(
                f"{found[order_id]} and {path} would both become the order '{order_id}'; rename one, or "
                "import each by itself with a --name"
            )
        found[order_id] = path
    for order_id, path in found.items():
        first, _, number = order_id.rpartition("-")
        if number.isdecimal() and first in found:
            raise OrderError(
                f"{path} would become the order '{order_id}', as would a further pallet of {found[first]}; "
                "rename one, or import each by itself with a --name"
            )
    return found


def _show(found: list[Proposal], output: Path) -> None:
    rows = [
        (
            str(output / f"{item.order.order_id}.json"), str(len(item.order.boxes)), f"{item.fill:.0%}",
            f"{max(float(box.upper[2]) for box in item.order.placed):.2f} m",
            str(sum(box.turn.handling == "table" for box in item.order.boxes)), f"{item.push:.2f} g",
            f"{item.hold_mm:.1f} mm",
        )
        for item in found
    ]  # fmt: skip
    head = ("order", "boxes", "volume used", "height", "stood up", "tips at", "shift under 0.2 g")
    note = "volume used: of the box around the stack, all its layers; tips at: by the closed rule"
    show_table(head, rows, note=note)


def _show_left(path: Path, proposals: Proposals) -> None:
    """Say, and write down, which items are in no order, and every reason."""
    names = ", ".join(item.id for item in proposals.left)
    lines = [*proposals.reasons, *([f"in no order: {names}"] if names else [])]
    path.write_text("".join(f"{line}\n" for line in lines))
    for line in lines:
        notice(line, typer.colors.RED if names else typer.colors.YELLOW, is_error=True)
    typer.echo(str(path))
