"""`pack benchmark packing`: many scenes in lockstep, as the paper's tables."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.benchmark_options import Fresh, Jobs, JsonFile, Output, Ray
from pack_bringup.cli.benchmark_run import RunOptions, run
from pack_core.packing.arrangement import FillMethod
from pack_mpc.optimizers import OPTIMIZERS


def benchmark(
    scenes: Annotated[int, typer.Option(min=1, help="Number of scenes.")] = 10,
    seed: Annotated[
        int, typer.Option(min=0, help="Seed of the first scene; each further scene has the next seed.")
    ] = 0,
    method: Annotated[
        str, typer.Option(help="pack_it_in, uninformed_pose or uninformed_physics.")
    ] = "pack_it_in",
    optimizer: Annotated[
        str | None,
        typer.Option(
            help=f"Optimizer to plan with: {', '.join(OPTIMIZERS)} (judo: an extra). Default: the node's."
        ),
    ] = None,
    weights: Annotated[
        str | None,
        typer.Option(
            help="Weights of the cost, a file of config/weights: `tuned` or `table_1`. Default: the node's."
        ),
    ] = None,
    preset: Annotated[str, typer.Option(help="Conditions of the run, a file of config/presets.")] = "ideal",
    container: Annotated[
        str | None,
        typer.Option(
            metavar="XxY", help="Inside lengths of the container [m], e.g. 0.24x0.19. Default: the cell's."
        ),
    ] = None,
    blocked: Annotated[
        bool,
        typer.Option(
            help="Generate scenes in which the new object fits nowhere without contact, or any scenes."
        ),
    ] = True,
    scene_dir: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Run the scene files of this folder instead of generated scenes."),
    ] = None,
    fill: Annotated[
        bool,
        typer.Option(
            "--fill", help="Fill empty containers from lists of 8 supermarket objects, one list a seed."
        ),
    ] = False,
    places: Annotated[
        FillMethod,
        typer.Option(help="With --fill: how places are chosen. no_contact and random are for comparison."),
    ] = FillMethod.CONTACT,
    jobs: Jobs = 1,
    threads: Annotated[
        int, typer.Option(min=0, help="Cores that a scene may use; 0: all, shared among the jobs.")
    ] = 0,
    ray: Ray = None,
    output: Output = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
    pictures: Annotated[
        int, typer.Option(min=0, help="Failed scenes whose last moment the report shows.")
    ] = 12,
    video_failures: Annotated[
        int, typer.Option(min=0, help="Failed scenes that are rendered whole, as MP4.")
    ] = 0,
) -> None:
    """Pack in many scenes without ROS, on simulated time, and report how it went.

    An iteration of the controller takes 48 ms of simulated time, however long it takes on this machine, so
    everything but the iteration times repeats bit for bit with any number of jobs. Results are kept scene by
    scene: the same command goes on where it was interrupted.

    - `pack benchmark packing --scenes 100 --seed 1000 --jobs 2 --json summary.json`
    - `pack benchmark packing --method uninformed_pose --optimizer sgn --weights table_1`
    - `pack benchmark packing --scenes 50 --seed 1000 --container 0.24x0.19`
    - `pack benchmark packing --scenes 20 --seed 1000 --preset objects_20 --no-blocked`
    - `pack benchmark packing --fill --scenes 50 --seed 3000 --json fill.json`
    - `pack evaluate bags/benchmarks/*` puts the results of several benchmarks side by side
    """
    from pack_core.config import validate_config
    from pack_core.errors import ConfigError
    from pack_lockstep.benchmarking.pools import cores
    from pack_lockstep.packing.benchmark import PackingBenchmark
    from pack_lockstep.packing.settings import BenchmarkSettings, parse_size, scene_jobs, set_up

    options = RunOptions(jobs, ray, output, fresh, json_file, pictures, video_failures)
    cores_each = threads or max(1, cores() // jobs)
    if fill:
        others = {
            "--method": method != "pack_it_in", "--optimizer": optimizer, "--weights": weights,
            "--container": container, "--scene-dir": scene_dir,
        }  # fmt: skip
        if given_too := [name for name, value in others.items() if value]:
            raise ConfigError(
                f"{', '.join(given_too)} beside --fill; allowed: --places, --preset, --scenes, --seed, and "
                "the options of every benchmark; the rest is for scenes"
            )
        from pack_lockstep.packing.fill_benchmark import PackingFillBenchmark, fill_setup, list_jobs

        filling = fill_setup(places, preset, cores_each)
        run(PackingFillBenchmark(filling, list_jobs(seed, scenes, filling.cell)), options)
        return
    given = {
        "method": method, "optimizer": optimizer, "weights": weights, "preset": preset,
        "container": parse_size(container) if container else None, "blocked": blocked,
        "scene_dir": scene_dir,
    }  # fmt: skip
    settings = validate_config(BenchmarkSettings, given, "pack benchmark packing")
    setup = set_up(settings, cores_each)
    run(PackingBenchmark(setup, tuple(scene_jobs(settings, seed, scenes))), options)
