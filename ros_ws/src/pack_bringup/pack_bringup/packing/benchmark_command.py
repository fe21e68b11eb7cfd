"""`pack benchmark packing`: many scenes in lockstep, as the paper's tables."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.studies import report_studies
from pack_bringup.cli.trial_progress import TrialProgress

if TYPE_CHECKING:
    from pack_evaluation.packing.study.trial import Trial


def benchmark(
    scenes: Annotated[int, typer.Option(min=1, help="How many.")] = 10,
    seed: Annotated[int, typer.Option(min=0, help="Of the first scene; the next has the next seed.")] = 0,
    method: Annotated[
        str, typer.Option(help="pack_it_in, uninformed_pose or uninformed_physics.")
    ] = "pack_it_in",
    optimizer: Annotated[
        str | None, typer.Option(help="ilqr, sgn or judo (an extra). Default: the node's.")
    ] = None,
    weights: Annotated[
        str | None, typer.Option(help="A set of config/weights: tuned or table_1. Default: the node's.")
    ] = None,
    preset: Annotated[str, typer.Option(help="Conditions: a file of config/presets.")] = "ideal",
    container: Annotated[
        str | None, typer.Option(metavar="XxY", help="Its inside [m], e.g. 0.24x0.19. Default: the cell's.")
    ] = None,
    scene_dir: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Run the scene files there, not generated scenes.")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Scenes at a time, each a process.")] = 1,
    threads: Annotated[
        int, typer.Option(min=0, help="Cores a scene; 0: all of them, shared among the jobs.")
    ] = 0,
    ray: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Of a Ray cluster to run on; `local` starts one.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Of the results; named below bags/ if not given."),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure anew what DIR has already.")] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the summary there, too.")
    ] = None,
    pictures: Annotated[int, typer.Option(min=0, help="Failed scenes that the report shows.")] = 12,
    video_failures: Annotated[int, typer.Option(min=0, help="Failed scenes to render as MP4.")] = 0,
) -> None:
    """Run many scenes without ROS on simulated time, and report how they went.

    An iteration of the controller takes 48 ms of simulated time, whatever it takes here, so everything but
    the iteration times repeats bit for bit, whatever the number of jobs. Results are kept scene by scene:
    the same command goes on where it was interrupted.

    - `pack benchmark packing --scenes 100 --seed 1000 --jobs 2 --json summary.json`
    - `pack benchmark packing --method uninformed_pose --optimizer sgn --weights table_1`
    - `pack benchmark packing --scenes 50 --seed 1000 --container 0.24x0.19`
    - `pack evaluate bags/benchmarks/*` puts the results of several benchmarks side by side
    """
    from pack_core.config import validate_config
    from pack_evaluation.packing.study.summary import summarize
    from pack_lockstep.benchmarking.pools import cores, open_pool
    from pack_lockstep.packing.benchmark import BenchmarkFolder, measure_scenes
    from pack_lockstep.packing.settings import BenchmarkSettings, parse_size, scene_jobs, set_up
    from pack_lockstep.packing.studies import Source

    options = {
        "method": method, "optimizer": optimizer, "weights": weights, "preset": preset,
        "container": parse_size(container) if container else None, "scene_dir": scene_dir,
    }  # fmt: skip
    settings = validate_config(BenchmarkSettings, options, "pack benchmark packing")
    share = threads or max(1, cores() // jobs)
    setup, wanted = set_up(settings, share), scene_jobs(settings, seed, scenes)
    folder = BenchmarkFolder(output or default_folder(setup.name))
    if fresh:
        folder.clear()
    names = [job.name for job in wanted]
    with open_pool(jobs, ray, share) as pool, TrialProgress(len(names), folder.count(names)) as bar:
        for trial in measure_scenes(folder, setup, wanted, pool):
            bar.add(trial.name, trial.measures.success, describe(trial))
    study = folder.study(names)
    source = Source(study, folder.load)
    report_studies([source], folder.path, title="Packing benchmark", pictures=pictures, videos=video_failures)
    if json_file:
        json_file.write_text(json.dumps(summarize(study), indent=2) + "\n")


def default_folder(name: str) -> Path:
    """Where results go: one folder a setting, so that the same command goes on."""
    from pack_core.paths import bags_path

    return bags_path() / "benchmarks" / name.replace(" ", "_")


def describe(trial: Trial) -> str:
    """A trial in some words."""
    m = trial.measures
    return (
        f"{m.exit_reason.value:12} {m.execution_time:5.1f} s {100 * m.distance:5.1f} cm "
        f"{m.force_mean:5.1f} N, peak {m.force_peak:5.0f} N {m.placements:2} placements"
    )
