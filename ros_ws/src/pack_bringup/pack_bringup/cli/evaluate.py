"""`pack evaluate`: what recordings say, and the reports of many runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from pack_bringup.cli.options import JsonFile
from pack_bringup.cli.outputs import make_output_folder, write_json
from pack_bringup.cli.terminal import notice, show_table

if TYPE_CHECKING:
    from pack_evaluation.evaluator import Evaluation, Evaluator
    from pack_lockstep.benchmarking.side_by_side import CellStudies

app = typer.Typer()


@app.command()
def evaluate(
    recordings: Annotated[
        list[Path],
        typer.Argument(metavar="BAG...", help="Runs' or bags' folders, .mcap files, folders of benchmarks."),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Folder of the report. Default: of one BAG its own, else bags/evaluation."
        ),
    ] = None,
    goal: Annotated[
        int | None,
        typer.Option(min=1, help="Which goal of a recording with several, from 1. Default: the last."),
    ] = None,
    video: Annotated[bool, typer.Option(help="Render a single run as MP4 (the slow part).")] = True,
    gif: Annotated[bool, typer.Option("--gif", help="Also an animated GIF of a single run.")] = False,
    still: Annotated[bool, typer.Option("--still", help="Also one large picture of a single run.")] = False,
    pictures: Annotated[int, typer.Option(min=0, help="Failed runs that the report of many shows.")] = 12,
    json_file: JsonFile = None,
) -> None:
    """Measure recorded runs again, from the recordings alone, or put results side by side.

    Of one recording it writes report.html, plots/ and run.mp4. Of several results, or of a benchmark's
    folder, it writes one report with tables for each cell: a benchmark has a row or column of its own in
    them, all recordings of a cell together have another.

    - `pack evaluate bags/packing_20260101_120000_seed0`
    - `pack evaluate bags/packing_20260101_120000_seed0 --no-video --json measures.json`
    - `pack evaluate bags/packing_20260101_120000 --goal 2`, of a cell that was given several
    - `pack evaluate run.mcap --output /tmp/report`
    - `pack evaluate bags/packing_* --json summary.json`
    - `pack evaluate bags/benchmarks/*`
    """
    from pack_core.paths import bags_path
    from pack_lockstep.benchmarking.results_folder import ResultsFolder

    first = recordings[0]
    if len(recordings) > 1 or ResultsFolder.is_at(first):
        measures = evaluate_many(recordings, output or bags_path() / "evaluation", pictures)
    else:
        folder = output or (first if first.is_dir() else first.parent)
        measures = evaluate_one(first, folder, video=video, gif=gif, still=still, goal=goal)
    if json_file:
        write_json(json_file, measures)


def evaluate_one(
    bag: Path, folder: Path, *, video: bool, gif: bool, still: bool, goal: int | None = None
) -> dict[str, Any]:
    """Report a run and return its measures."""
    from pack_evaluation.video_file import write_gif

    evaluator = evaluator_of(bag)
    make_output_folder(folder)
    found = run_evaluation(evaluator, bag, folder, with_video=video or gif, goal=goal)
    show(found)
    if gif and found.video:
        write_gif(found.video, found.video.with_suffix(".gif"))
    if still:
        evaluator.still(found.run, folder / "run.png")
    return found.to_json()


def evaluate_many(recordings: list[Path], folder: Path, pictures: int) -> dict[str, Any]:
    """Report studies and return their summaries: by name or, of several cells, by cell and name."""
    from pack_core.errors import BagError
    from pack_lockstep.benchmarking.side_by_side import gather

    make_output_folder(folder)
    with Progress(TextColumn("reading"), BarColumn(), MofNCompleteColumn(), transient=True) as bar:
        task = bar.add_task("reading", total=len(recordings))
        found = gather(recordings, lambda _: bar.advance(task))
    for path, reason in found.left_out.items():
        notice(f"left out {path}: {reason}", typer.colors.YELLOW, is_error=True)
    if not found.cells:
        raise BagError(f"none of the {len(recordings)} paths holds a recording or a benchmark's results")
    title = " and ".join(item.evaluator.title for item in found.cells)
    summaries = report_studies(found.cells, folder, title=f"{title} runs", pictures=pictures)
    return summaries if len(summaries) > 1 else next(iter(summaries.values()))


def evaluator_of(bag: Path) -> Evaluator[Any, Any]:
    """The evaluator of the recording's cell, which run.yaml names."""
    from pack_core.cells import cell_part
    from pack_evaluation.record import cell_of

    evaluator: Evaluator[Any, Any] = cell_part(cell_of(bag), "evaluator")
    return evaluator


def run_evaluation(
    evaluator: Evaluator[Any, Any], bag: Path, output: Path, *, with_video: bool, goal: int | None = None
) -> Evaluation[Any, Any]:
    """Evaluate with a progress bar for the video; with it comes the interactive replay."""
    from pack_core.cells import optional_cell_part
    from pack_evaluation.record import cell_of
    from pack_viewer.replay import write_replay

    has_bag = bag.is_dir() or bag.suffix == ".mcap"  # and not what a benchmark keeps of a run
    with_replay = with_video and has_bag and optional_cell_part(cell_of(bag), "page") is not None
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, transient=True) as bar:
        task = bar.add_task("evaluating", total=1.0)
        return evaluator.evaluate(
            bag, output, with_video=with_video, write_replay=write_replay if with_replay else None,
            progress=lambda done: bar.update(task, completed=done, description="rendering"), goal=goal,
        )  # fmt: skip


def show(found: Evaluation[Any, Any]) -> None:
    """Print the table of the measures, and where the report is."""
    show_table(("measure", "value", "what it is"), [(r.name, r.value, r.meaning) for r in found.rows])
    console = Console()
    which = found.run.goal
    if which.count > 1:
        others = f"this recording holds {which.count} goals, and this is goal {which.number}"
        notice(f"{others}: --goal 1 to {which.count} chooses", typer.colors.YELLOW)
    if found.run.is_cut:
        notice("the recording was cut off; all in front of the cut was evaluated", typer.colors.YELLOW)
    if found.run.damaged:
        what = f"{found.run.damaged} pieces of the recording could not be read; the rest was evaluated"
        notice(what, typer.colors.YELLOW)
    for note in found.run.notes:
        notice(note, typer.colors.YELLOW)
    console.print(f"report: {found.report}", soft_wrap=True, markup=False)
    if found.video:
        console.print(f"video:  {found.video}", soft_wrap=True, markup=False)
    if found.replay:
        console.print(f"replay: {found.replay}", soft_wrap=True, markup=False)


def report_studies(
    cells: Sequence[CellStudies], folder: Path, *, title: str, pictures: int, videos: int = 0
) -> dict[str, dict[str, Any]]:
    """Print the tables, write the report, and say where it is.

    Args:
        cells: the studies of each cell.
        folder: for report.html, figures/ and pictures of single runs.
        title: of the report.
        pictures: single runs of each study that the report draws.
        videos: single runs of each study that are rendered whole.

    Returns:
        The summaries by cell and name of the study.
    """
    from pack_evaluation.study import summaries
    from pack_evaluation.study_report import study_section, write_study_report

    console, sections = Console(), []
    for item in cells:
        below = folder if len(cells) == 1 else folder / item.evaluator.title.lower().replace(" ", "_")
        section = study_section(
            item.evaluator, item.studies, below, pictures=pictures, videos=videos, warn=_warn
        )
        for table in section.tables:
            show_table(table.head, table.rows, title=table.title, note=table.note)
        sections.append(section)
    report = write_study_report(sections, folder, title)
    console.print(f"report: {report}", soft_wrap=True, highlight=False)
    found: dict[str, dict[str, Any]] = {}
    for item in cells:
        found.setdefault(item.cell, {}).update(summaries(item.evaluator, item.studies))
    return found


def _warn(text: str) -> None:
    notice(text, typer.colors.YELLOW, is_error=True)
