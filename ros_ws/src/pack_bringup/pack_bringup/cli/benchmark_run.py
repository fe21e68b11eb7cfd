"""Runs a benchmark before your eyes: a bar, a line a trial, then tables and a report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from pack_bringup.cli.evaluate import report_studies
from pack_bringup.cli.outputs import command_line, make_output_folder, write_json
from pack_bringup.cli.terminal import TrialProgress, notice

if TYPE_CHECKING:
    from pack_lockstep.benchmarking.benchmark import Benchmark
    from pack_lockstep.benchmarking.results_folder import ResultsFolder


@dataclass(frozen=True)
class RunOptions:
    """The options that every benchmark command has, apart from those of what it measures.

    Attributes:
        jobs: trials at a time on this machine.
        ray: address of a Ray cluster to run on instead.
        output: folder of the results; None: named after the settings.
        fresh: delete what the folder has already.
        json_file: takes the summary, too.
        pictures: single runs that the report draws.
        videos: single runs that are rendered as MP4.
    """

    jobs: int = 1
    ray: str | None = None
    output: Path | None = None
    fresh: bool = False
    json_file: Path | None = None
    pictures: int = 0
    videos: int = 0


def run(benchmark: Benchmark[Any, Any], options: RunOptions) -> None:
    """Run what the folder does not have yet, print the tables, and write summary.json and report.html.

    Raises:
        PackError: the folder is of other settings, a trial cannot be run, or there is no such cluster.
    """
    from pack_core.cells import cell_part
    from pack_core.paths import bags_path
    from pack_core.used_files import used_since_watch
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.benchmark import run_benchmark
    from pack_lockstep.benchmarking.pools import open_pool
    from pack_lockstep.benchmarking.results_folder import SUMMARY, ResultsFolder
    from pack_lockstep.benchmarking.side_by_side import CellStudies

    set_up_with = used_since_watch()
    folder = ResultsFolder(options.output or bags_path() / "benchmarks" / benchmark.folder_name)
    make_output_folder(folder.path)
    if options.fresh:
        folder.clear(benchmark.files)
    warn_of_other_code(folder)
    names, origin = [job.name for job in benchmark.jobs], provenance(command_line())
    with (
        open_pool(options.jobs, options.ray, benchmark.threads) as pool,
        TrialProgress(len(names), folder.count(names)) as bar,
    ):
        for trial in run_benchmark(benchmark, folder, pool, origin, set_up_with):
            bar.add(trial)
    evaluator = cell_part(benchmark.cell, benchmark.studies)
    studies = evaluator.of_benchmark(folder.kept(names))
    cells = (CellStudies(benchmark.cell, evaluator, tuple(studies)),)
    found = report_studies(
        cells, folder.path, title=f"{evaluator.title} benchmark", pictures=options.pictures,
        videos=options.videos,
    )  # fmt: skip
    summaries = found[benchmark.cell]
    # Several studies, as of several methods, are told apart by name; a single one needs none.
    summary = summaries if len(summaries) > 1 else next(iter(summaries.values()))
    for path in filter(None, (folder.path / SUMMARY, options.json_file)):
        write_json(path, summary)


def warn_of_other_code(folder: ResultsFolder) -> None:
    """Settings are compared and refused; whoever goes on with other code should know."""
    if not (changed := folder.changed_sources()):
        return
    text = (
        f"the trials in {folder.path} were made before {changed[0]}"
        + (f" and {len(changed) - 1} other files" if len(changed) > 1 else "")
        + " changed, on which they depend; --fresh measures all anew"
    )
    notice(text, typer.colors.YELLOW, is_error=True)
