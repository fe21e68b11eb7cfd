"""The packing cell on the command line: goal, demo and benchmark."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.benchmark_run import RunOptions, run
from pack_bringup.cli.options import (
    BenchmarkFolder,
    CellAddress,
    Domain,
    FreeDomain,
    Fresh,
    Jobs,
    JsonFile,
    Live,
    Namespace,
    Network,
    Port,
    Ray,
    RealTimeFactor,
    Reset,
    RunFolder,
    Video,
    page_process,
)
from pack_bringup.cli.outputs import command_line
from pack_bringup.cli.pursue import run_goal, run_live
from pack_bringup.packing import calibration as _calibration  # noqa: F401, adds `pack calibrate packing`
from pack_bringup.recording.run_record import default_folder
from pack_core.addresses import PAGE_PORT
from pack_core.errors import ConfigError
from pack_core.packing.goals import FillMethod, PackingMethod
from pack_mpc.optimizers import OPTIMIZERS

if TYPE_CHECKING:
    from pack_lockstep.packing.benchmark import PackingFillBenchmark

Seed = Annotated[
    int,
    typer.Option(
        min=0, help="Seed of the generated scene, of the sensors' noise and of the placement planner."
    ),
]
SceneFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Pack in the scene of this file instead of a generated one.",
    ),
]
Method = Annotated[PackingMethod, typer.Option(help="The paper's method, or one of its baselines.")]

Fill = Annotated[
    bool,
    typer.Option(
        "--fill", help="Fill an empty container from LIST, or from 8 supermarket objects of the seed."
    ),
]
ListFile = Annotated[
    Path | None,
    typer.Argument(metavar="LIST", help="With --fill: a list file."),
]


def goal(
    seed: Seed = 0,
    scene: SceneFile = None,
    method: Method = PackingMethod.PACK_IT_IN,
    fill: Fill = False,
    given: ListFile = None,
    reset: Reset = True,
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
) -> None:
    """Have a running cell pack one object, or fill its container from a list.

    The exit code is 0 if all was packed, 1 if not, and 2 if the goal was refused. Ctrl-C cancels the goal.

    - `pack goal packing --seed 3`
    - `pack goal packing --scene config/scenarios/packing/example.yaml --domain 7`
    - `pack goal packing --no-reset`, to go on with the scene as it stands
    - `pack goal packing --fill config/packing_lists/example.yaml`
    """
    from pack_bringup.packing.goals import PackingGoal, fill_goal
    from pack_core.packing.scene_file import scene_text

    at = CellAddress(domain, namespace, network)
    if is_fill(fill, given, scene, method):
        run_goal(fill_goal(seed, given), at, reset=reset)
    if scene is not None:
        scene_text(scene)  # a file that cannot be read is refused before anybody is asked
    run_goal(PackingGoal(seed, scene, method.value), at, reset=reset)


def is_fill(fill: bool, given: Path | None, scene: Path | None, method: PackingMethod) -> bool:
    """Whether a container is to be filled; raises ConfigError for options that do not go with it."""
    if not (fill or given):
        return False
    if scene is not None:
        raise ConfigError("--scene beside --fill; allowed: LIST, which has its own container")
    if method is not PackingMethod.PACK_IT_IN:
        raise ConfigError(f"--method {method.value} beside --fill; allowed: none, baselines pack one object")
    return True


def demo(
    seed: Seed = 0,
    scene: SceneFile = None,
    method: Method = PackingMethod.PACK_IT_IN,
    preset: Annotated[
        str,
        typer.Option(help="Conditions by name, e.g. `hardware`: its file is in config/presets."),
    ] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="What `pack calibrate packing` has found under this preset."),
    ] = None,
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    fill: Fill = False,
    given: ListFile = None,
    live: Live = False,
    port: Port = PAGE_PORT,
    output: RunFolder = None,
    domain: FreeDomain = None,
) -> None:
    """Pack one object: five nodes, one goal, and a report at the end.

    The container has no free place for the object, so the arm makes one by pushing. The run's folder then
    holds the recording (bag/), report.html, plots/, run.mp4, the scene, the configuration and the nodes' log.
    The exit code is 0 only if the object was packed. Scenes, lists and presets are described in
    docs/cells/packing/scenes.md, filling.md and presets.md.

    - `pack demo packing --seed 3`
    - `pack demo packing --method uninformed_pose --no-video`
    - `pack demo packing --preset hardware`
    - `pack demo packing --scene config/scenarios/packing/example.yaml --real-time-factor 0.3`
    - `pack demo packing --fill config/packing_lists/example.yaml`
    - `pack demo packing --preset installed --calibration calibration.yaml --real-time-factor 0.5`
    """
    from pack_bringup.packing.goals import PackingJob, cell_of
    from pack_core.packing.scene_file import load_scene

    if scene is not None:
        load_scene(scene, cell_of(preset))
    folder = output or default_folder("packing", seed, datetime.now(), preset)
    job: PackingJob
    if is_fill(fill, given, scene, method):
        from pack_bringup.packing.goals import packing_fill_job

        job = packing_fill_job(
            seed, given, folder=folder, real_time_factor=real_time_factor, command=command_line(),
            preset=preset, calibration=calibration,
        )  # fmt: skip
    else:
        job = PackingJob(
            seed, scene, method.value, folder=folder, real_time_factor=real_time_factor,
            command=command_line(), preset=preset, calibration=calibration,
        )  # fmt: skip
    run_live(job, video=video, domain=domain, page=page_process("packing", live, port))


def _filling(places: FillMethod, preset: str, threads: int, seed: int, lists: int) -> PackingFillBenchmark:
    """The benchmark of lists; without markers it needs modules that one with markers never loads."""
    from pack_core.packing.cell import Perception
    from pack_lockstep.packing.benchmark import PackingFillBenchmark, fill_setup, list_jobs
    from pack_lockstep.packing.lockstep_config import load_preset

    if load_preset(preset).packing_cell().perception is Perception.DEPTH:
        from pack_lockstep.packing.depth_fill import DepthFillBenchmark, depth_fill_setup

        setup = depth_fill_setup(places, preset, threads)
        return DepthFillBenchmark(setup, list_jobs(seed, lists, setup.cell))
    setup = fill_setup(places, preset, threads)
    return PackingFillBenchmark(setup, list_jobs(seed, lists, setup.cell))


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
            help="Weights of the cost, by the name of a file of config/weights. Default: the node's."
        ),
    ] = None,
    preset: Annotated[str, typer.Option(help="Conditions: name of a file of config/presets.")] = "ideal",
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
    output: BenchmarkFolder = None,
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
    - `pack benchmark packing --fill --preset unknown --scenes 6 --seed 500`, filled by what depth cameras see
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
            "--container": container, "--scene-dir": scene_dir, "--no-blocked": not blocked,
        }  # fmt: skip
        if given_too := [name for name, value in others.items() if value]:
            raise ConfigError(
                f"{', '.join(given_too)} beside --fill; allowed: --places, --preset, --scenes, --seed, and "
                "the options of every benchmark; the rest is for scenes"
            )
        run(_filling(places, preset, cores_each, seed, scenes), options)
        return
    if places is not FillMethod.CONTACT:
        raise ConfigError(f"--places {places.value} without --fill; allowed: both, or neither of them")
    given = {
        "method": method, "optimizer": optimizer, "weights": weights, "preset": preset,
        "container": parse_size(container) if container else None, "blocked": blocked,
        "scene_dir": scene_dir,
    }  # fmt: skip
    settings = validate_config(BenchmarkSettings, given, "pack benchmark packing")
    setup = set_up(settings, cores_each)
    run(PackingBenchmark(setup, tuple(scene_jobs(settings, seed, scenes))), options)
