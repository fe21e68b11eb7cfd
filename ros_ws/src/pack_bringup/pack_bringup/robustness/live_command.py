"""`pack benchmark live`: the graph of a cell in real time, one goal a seed."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pack_bringup.cli.benchmark_run import warn_of_other_code
from pack_bringup.cli.evaluate import evaluate_many
from pack_bringup.cli.options import BenchmarkFolder, Fresh, JsonFile, RealTimeFactor, prepare_network
from pack_bringup.cli.outputs import command_line, make_output_folder, write_json
from pack_bringup.cli.terminal import TrialProgress, end_as_by_ctrl_c, notice, show_table
from pack_core.cells import CELLS

if TYPE_CHECKING:
    from pack_lockstep.benchmarking.results_folder import ResultsFolder, TrialFile

GOALS, RUNS, USED = "goals.jsonl", "runs", "used_files"
"""What it leaves in its folder besides the results: how each goal went, recordings, and within each of these
what the nodes used of the project."""


def live(
    cell: Annotated[str, typer.Argument(help="Cell to run, e.g. `packing`.")],
    seeds: Annotated[
        str, typer.Option(metavar="FIRST..LAST", help="Seeds of the goals, both ends included.")
    ] = "0..9",
    beside: Annotated[
        int, typer.Option(min=0, help="Other programs that each take a processor meanwhile.")
    ] = 0,
    preset: Annotated[str, typer.Option(help="Conditions, as of `pack demo`. Default: the files.")] = "",
    real_time_factor: RealTimeFactor = None,
    output: BenchmarkFolder = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Run the graph of a cell in real time, one goal a seed, and tell how it went and whether time kept up.

    Each goal has nodes of its own, as `pack demo` starts them, and a recording below DIR/runs. The table says
    how fast time ran, and which share of the controller's iterations took too long. With --beside other
    programs compete for the processors, at normal priority. How it goes depends on the machine: end what else
    runs. Interrupted, it goes on where it was. The nodes tell what they use of the project, so that
    `pack results` knows which code a figure is of.

    - `pack benchmark live packing --seeds 0..9 --json live.json`
    - `pack benchmark live packing --seeds 0..9 --beside 1`
    - `pack benchmark live palletizing --seeds 0..3 --real-time-factor 1`
    """
    prepare_network()
    from pack_bringup.robustness.live import GOAL_COLUMNS, goal_row, seeds_of, summary
    from pack_core.cells import check_cell
    from pack_core.errors import BagError
    from pack_core.paths import bags_path
    from pack_core.used_files import used_since_watch
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.results_folder import SUMMARY, ResultsFolder, TrialFile

    wanted, kind = seeds_of(seeds), f"live_{check_cell(cell)}" + (f"_beside_{beside}" if beside else "")
    folder = output or bags_path() / "benchmarks" / (kind + (f"_{preset}" if preset else ""))
    results = ResultsFolder(folder)
    make_output_folder(folder)
    if fresh:
        shutil.rmtree(folder / RUNS, ignore_errors=True)
        results.clear([GOALS])
    warn_of_other_code(results)
    end_as_by_ctrl_c()
    settings = {"beside": beside, "preset": preset, "real_time_factor": real_time_factor}
    goals = TrialFile(folder / GOALS, cell, settings, provenance(command_line()))
    left = [seed for seed in wanted if f"seed {seed}" not in goals.trials]
    _run_live(cell, left, len(wanted), goals, results, settings)
    kept = [goals.trials[f"seed {seed}"] for seed in wanted]
    found = summary(kept)
    show_table(GOAL_COLUMNS, [goal_row(report) for report in kept], title=f"{cell} in real time")
    recordings = [folder / RUNS / f"seed_{seed}" for seed in wanted]
    measured: dict[str, Any] = {}
    try:  # all recordings together are one study
        (measured,) = evaluate_many(recordings, folder, pictures=0).values()
    except BagError as error:  # no goal began its work: that, too, is a result
        notice(str(error), typer.colors.YELLOW, is_error=True)
    results.add_sources(_of_cell(cell, used_since_watch()))  # also what made figures of the recordings
    for path in filter(None, (folder / SUMMARY, json_file)):
        write_json(path, {**measured, "live": {**settings, **found}})


def _run_live(
    cell: str, seeds: Sequence[int], total: int, goals: TrialFile, results: ResultsFolder,
    settings: Mapping[str, Any],
) -> None:  # fmt: skip
    """Run and keep the goals of `seeds`, the recording of each in a folder of its own, and what was used."""
    from pack_bringup.graph.graph import load_graph
    from pack_bringup.job import SeededJob, run_demo
    from pack_bringup.robustness.live import busy_processes, goal_report, goal_row
    from pack_core.cells import cell_part
    from pack_core.errors import PackError
    from pack_core.used_files import data_files, told, used_since_watch
    from pack_lockstep.benchmarking.benchmark import Verdict

    make: SeededJob = cell_part(cell, "seeded_job")
    # The nodes read these in C, where Python hears nothing of it.
    parameter_files = data_files(str(node.parameters_path) for node in load_graph(cell).nodes)
    with busy_processes(settings["beside"]), TrialProgress(total, total - len(seeds)) as bar:
        for seed in seeds:
            run = results.path / RUNS / f"seed_{seed}"
            shutil.rmtree(run, ignore_errors=True)
            job = make(
                seed, run, real_time_factor=settings["real_time_factor"], preset=settings["preset"],
                command=command_line(),
            )  # fmt: skip
            job.overrides()  # which refuses conditions that there are not, before anything is counted
            try:
                result, pace = run_demo(job, lambda _: None, used_files=run / USED)
                report = goal_report(seed, result.success, result.message, pace)
            except PackError as error:
                report = goal_report(seed, False, str(error), None)
            results.add_sources(_of_cell(cell, used_since_watch() | parameter_files | told(run / USED)))
            goals.add(report)
            bar.add(Verdict(report["name"], report["success"], ", ".join(filter(None, goal_row(report)[1:]))))


def _of_cell(cell: str, sources: Iterable[str]) -> frozenset[str]:
    """The sources but for other cells' graphs, which are read to see whether one of them runs already."""
    others = {f"config/graphs/{other}.yaml" for other in CELLS if other != cell}
    return frozenset(sources) - others
