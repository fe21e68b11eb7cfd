"""`pack evaluate` and `pack bag`: what a recording says."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

if TYPE_CHECKING:
    from pack_core.evaluation.evaluate import Evaluation

app = typer.Typer()
bag_app = typer.Typer(no_args_is_help=True, help="Look into recordings.")
app.add_typer(bag_app, name="bag")

BagPath = Annotated[
    Path, typer.Argument(metavar="BAG", help="A run's folder, a bag's folder or an .mcap file.")
]


@app.command()
def evaluate(
    bag: BagPath,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder of the report; BAG's own if not given.")
    ] = None,
    video: Annotated[bool, typer.Option(help="Render the run as MP4 (the slow part).")] = True,
    gif: Annotated[bool, typer.Option("--gif", help="Also an animated GIF.")] = False,
    still: Annotated[bool, typer.Option("--still", help="Also one large picture.")] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Also the measures as JSON.")
    ] = None,
) -> None:
    """Measure a recorded run again, from the bag alone, and write report.html, plots/ and run.mp4.

    - `pack evaluate bags/packing_20260101_120000_seed0`
    - `pack evaluate bags/packing_20260101_120000_seed0 --no-video --json measures.json`
    - `pack evaluate run.mcap --output /tmp/report`
    """
    from pack_core.evaluation.video import write_gif, write_still

    folder = output or (bag if bag.is_dir() else bag.parent)
    found = run_evaluation(bag, folder, with_video=video or gif)
    show(found)
    if gif and found.video:
        write_gif(found.video, found.video.with_suffix(".gif"))
    if still:
        write_still(found.run, folder / "run.png")
    if json_file:
        json_file.write_text(json.dumps(found.to_json(), indent=2) + "\n")


@bag_app.command()
def info(bag: BagPath) -> None:
    """List what a bag holds, also one that was cut off.

    - `pack bag info bags/packing_20260101_120000_seed0`
    """
    from pack_core import stamps
    from pack_core.evaluation.bag import read_bag

    found = read_bag(bag)
    times = [item.time_ns for item in found.messages]
    table = Table("topic", "messages", title=str(found.path))
    for topic, count in found.counts().items():
        table.add_row(topic, str(count))
    Console().print(table)
    typer.echo(f"{stamps.to_seconds(max(times, default=0)):.3f} s of simulated time, {len(times)} messages")
    if found.is_cut:
        typer.echo("the recording was cut off; all in front of the cut was read")


@bag_app.command()
def copy(
    bag: BagPath,
    target: Annotated[Path, typer.Argument(help="The new bag's folder.")],
    start: Annotated[float, typer.Option("--from", help="Simulated time [s].")] = 0.0,
    end: Annotated[float, typer.Option("--to", help="Simulated time [s].")] = float("inf"),
    topics: Annotated[
        list[str] | None, typer.Option("--topic", help="This topic only; may be repeated.")
    ] = None,
) -> None:
    """Copy a bag or a stretch of it, compressed; a bag that was cut off becomes a finished one.

    - `pack bag copy bags/packing_20260101_120000_seed0 short --from 2 --to 5`
    """
    from pack_bringup.bag_copy import copy_bag

    copied = copy_bag(bag, target, start=start, end=end, topics=topics)
    note = " of a recording that was cut off" if copied.was_cut else ""
    typer.echo(f"{copied.messages} messages{note} in {target}")


def run_evaluation(bag: Path, output: Path, *, with_video: bool) -> Evaluation:
    """Evaluate with a progress bar for the video."""
    from pack_core.evaluation.evaluate import evaluate as evaluate_bag

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, transient=True) as bar:
        task = bar.add_task("evaluating", total=1.0)
        return evaluate_bag(
            bag, output, with_video=with_video,
            progress=lambda done: bar.update(task, completed=done, description="rendering"),
        )  # fmt: skip


def show(found: Evaluation) -> None:
    """Print the table of the measures, and where the report is."""
    from pack_core.evaluation.table import table_rows

    table = Table("measure", "value", "what it is")
    for row in table_rows(found.measures):
        table.add_row(row.name, row.value, row.meaning)
    console = Console()
    console.print(table)
    if found.run.is_cut:
        console.print("[yellow]the recording was cut off; all in front of the cut was evaluated[/]")
    console.print(f"report: {found.report}", soft_wrap=True)
    if found.video:
        console.print(f"video:  {found.video}", soft_wrap=True)
