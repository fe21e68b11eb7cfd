"""The blocks cell on the command line: `pack goal blocks`, `pack demo blocks`, `pack benchmark blocks`."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

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
from pack_bringup.recording.run_record import default_folder
from pack_core.addresses import PAGE_PORT
from pack_core.errors import ConfigError

BLOCKS, DENSITY = 9, 0.2
"""Of a problem that is generated, unless others are asked for."""

Blocks = Annotated[int, typer.Option(min=1, max=25, help="Number of blocks.")]
Density = Annotated[
    float, typer.Option(min=0.01, max=0.4, help="Share of the workspace that the blocks cover.")
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the generated problem and of the planner.")]
Mixed = Annotated[bool, typer.Option("--mixed", help="Cuboids of several sizes instead of equal cubes.")]
ProblemFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Solve the problem of this file instead of a generated one."),
]
Method = Annotated[
    str,
    typer.Option(
        "--method",
        "--planner",
        help="Planner by its name: `beam`, `pirs`, or one of your own. Default: `beam`.",
    ),
]


def goal(
    blocks: Blocks = BLOCKS,
    density: Density = DENSITY,
    seed: Seed = 0,
    mixed: Mixed = False,
    problem: ProblemFile = None,
    method: Method = "",
    reset: Reset = True,
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
) -> None:
    """Have a running cell rearrange blocks into a dense grid.

    The exit code is 0 if every block is at its goal, 1 if not, and 2 if the goal was refused. Ctrl-C cancels
    the goal.

    - `pack goal blocks --blocks 4 --seed 3`
    - `pack goal blocks --problem config/scenarios/blocks/example.yaml --domain 7`
    """
    from pack_bringup.blocks.goals import BlocksGoal, problem_of

    _refuse_beside(problem, blocks, density, mixed=mixed)
    wanted = BlocksGoal(problem_of(problem, blocks, density, seed, mixed), seed, _checked(method))
    run_goal(wanted, CellAddress(domain, namespace, network), reset=reset)


def _refuse_beside(problem: Path | None, blocks: int, density: float, *, mixed: bool) -> None:
    """Raise ConfigError where a file and what is generated instead of it are both asked for."""
    given = {"--blocks": blocks != BLOCKS, "--density": density != DENSITY, "--mixed": mixed}
    if problem is not None and (names := [name for name, is_given in given.items() if is_given]):
        raise ConfigError(
            f"{', '.join(names)} beside --problem; allowed: one of them, the file says what there is"
        )


def _checked(method: str) -> str:
    """The method, if there is such a planner; raises ConfigError, before anything is started, if not."""
    from pack_planner.rearrangement.methods import METHODS

    return METHODS.checked(method) if method else ""


def demo(
    blocks: Blocks = BLOCKS,
    density: Density = DENSITY,
    seed: Seed = 0,
    mixed: Mixed = False,
    problem: ProblemFile = None,
    method: Method = "",
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    live: Live = False,
    port: Port = PAGE_PORT,
    output: RunFolder = None,
    domain: FreeDomain = None,
) -> None:
    """Rearrange blocks into a dense grid: six nodes, one goal, and a report at the end.

    The run's folder then holds the recording (bag/), report.html, plots/, run.mp4, the problem, the
    configuration and the nodes' log. The exit code is 0 only if every block is at its goal.

    - `pack demo blocks --blocks 4 --seed 3`
    - `pack demo blocks --blocks 4 --mixed`
    - `pack demo blocks --problem config/scenarios/blocks/example.yaml --method pirs`
    """
    from pack_bringup.blocks.goals import BlocksJob, problem_of

    _refuse_beside(problem, blocks, density, mixed=mixed)
    text = problem_of(problem, blocks, density, seed, mixed)
    folder = output or default_folder("blocks", seed, datetime.now())
    job = BlocksJob(
        text, seed, _checked(method), folder=folder, real_time_factor=real_time_factor, command=command_line()
    )
    run_live(job, video=video, domain=domain, page=page_process("blocks", live, port))


def benchmark(
    blocks: Annotated[int, typer.Option(min=1, max=25, help="Number of blocks of an instance.")] = 9,
    density: Annotated[
        float, typer.Option(min=0.01, max=0.6, help="Share of the workspace that the blocks cover.")
    ] = 0.2,
    instances: Annotated[
        int, typer.Option(min=1, help="Number of instances, with seeds from --seed on.")
    ] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first instance and of its planner.")] = 0,
    mixed: Mixed = False,
    problem: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE", help="Solve the problem of this file instead of generated ones; may be repeated."
        ),
    ] = None,
    method: Annotated[
        list[str] | None,
        typer.Option("--method", "--planner", help="Planner by its name, e.g. `beam`; may be repeated."),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="PLANNER.PARAM=VALUE", help="Change a planner's parameter; may be repeated."
        ),
    ] = None,
    price: Annotated[
        str | None,
        typer.Option(help="What beam's plans have least of: actions, or paper (Eq. 1). Default: configured."),
    ] = None,
    budget: Annotated[float, typer.Option(min=0.01, help="Processor time that a plan may take [s].")] = 1.0,
    execute: Annotated[
        bool, typer.Option("--execute", help="Have the simulated arm carry out every plan.")
    ] = False,
    jobs: Jobs = 1,
    ray: Ray = None,
    output: BenchmarkFolder = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
    pictures: Annotated[
        int, typer.Option(min=0, help="Number of instances whose plans the report draws.")
    ] = 2,
) -> None:
    """Plan rearrangements, check every plan by other code, and carry them out where asked to.

    An instance is a dense grid as goal and blocks scattered around it; the same number, density and seed give
    the same instance. With several methods all plan the same instances and are shown side by side. The
    report, beside the results, has the tables and plans drawn step by step.

    Results are kept as they come: the same command goes on where it was interrupted, and --fresh measures
    anew. Executions run without ROS on simulated time, with pictures, and repeat bit for bit; planning
    times are those of this machine.

    - `pack benchmark blocks --blocks 9 --method beam --method pirs` compares both planners
    - `pack benchmark blocks --blocks 16 --density 0.2 --instances 100 --json summary.json`
    - `pack benchmark blocks --price paper` has `beam` avoid pushes, above all long ones
    - `pack benchmark blocks --method pirs --set pirs.costs.collision=8` makes clearing dear (alpha_3)
    - `pack benchmark blocks --mixed` plans for cuboids of several sizes
    - `pack benchmark blocks --problem config/scenarios/blocks/example.yaml` plans an own instance
    - `pack benchmark blocks --blocks 4 --instances 100 --execute` has the arm do it
    """
    from pack_bringup.graph.graph import parse_overrides
    from pack_core.blocks.cell import blocks_cell
    from pack_core.config import merged
    from pack_lockstep.blocks.benchmark import BlocksBenchmark, BlocksSetup, PlanJob
    from pack_lockstep.blocks.benchmark_instances import wanted_instances
    from pack_lockstep.blocks.settings import lockstep_config
    from pack_planner.rearrangement.methods import DEFAULT_METHOD, METHODS

    methods = list(dict.fromkeys(METHODS.checked(name) for name in method or [DEFAULT_METHOD]))
    found = wanted_instances(blocks, density, range(seed, seed + instances), problem or [], mixed=mixed)
    wanted = tuple(PlanJob(name, instance) for instance in found for name in methods)
    planners = merged({"beam": {"price": price}} if price else {}, parse_overrides(settings or []))
    setup = BlocksSetup(blocks_cell(), lockstep_config(planners), budget, execute)
    run(BlocksBenchmark(setup, wanted), RunOptions(jobs, ray, output, fresh, json_file, pictures))
