"""`pack bag`: look into recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.terminal import show_table

app = typer.Typer()
bag_app = typer.Typer(no_args_is_help=True, help="Look into recordings.")
app.add_typer(bag_app, name="bag")

BagPath = Annotated[
    Path, typer.Argument(metavar="BAG", help="A run's folder, a bag's folder or an .mcap file.")
]


@bag_app.command()
def info(bag: BagPath) -> None:
    """List what a bag holds, also one that was cut off.

    - `pack bag info bags/packing_20260101_120000_seed0`
    """
    from pack_bringup.recording.playback import stretch
    from pack_core.stamps import to_seconds
    from pack_evaluation.bag import decoded
    from pack_evaluation.raw_bag import read_raw_bag

    raw = read_raw_bag(bag)
    found = decoded(raw)
    counts = [(topic, str(count)) for topic, count in found.counts().items()]
    show_table(("topic", "messages"), counts, title=str(found.path))
    first, last = (to_seconds(time) for time in stretch(raw) or (0, 0))
    typer.echo(
        f"{last - first:.3f} s of simulated time, from {first:.3f} s to {last:.3f} s; "
        f"{len(found.messages)} messages"
    )
    if found.is_cut:
        typer.echo("the recording was cut off; all in front of the cut was read")
    if found.damaged:
        typer.echo(f"{found.damaged} pieces of the recording could not be read; the rest was")
    for note in found.notes:
        typer.echo(note)


@bag_app.command()
def copy(
    bag: BagPath,
    target: Annotated[Path, typer.Argument(help="The new bag's folder.")],
    start: Annotated[float, typer.Option("--from", help="Simulated time to begin at [s].")] = 0.0,
    end: Annotated[float, typer.Option("--to", help="Simulated time to end at [s].")] = float("inf"),
    topics: Annotated[
        list[str] | None, typer.Option("--topic", help="Copy only this topic; may be repeated.")
    ] = None,
) -> None:
    """Copy a bag or a part of it, compressed; a bag that was cut off becomes a whole one.

    - `pack bag copy bags/packing_20260101_120000_seed0 short --from 2 --to 5`
    """
    from pack_bringup.recording.bag_copy import copy_bag

    copied = copy_bag(bag, target, start=start, end=end, topics=topics)
    note = " of a recording that was cut off" if copied.was_cut else ""
    if copied.damaged:
        note += f", without {copied.damaged} pieces that could not be read,"
    typer.echo(f"{copied.messages} messages{note} in {target}")
    for left_out in copied.notes:
        typer.echo(left_out)
