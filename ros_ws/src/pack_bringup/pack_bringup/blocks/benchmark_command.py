"""`pack benchmark blocks`: rearrangement problems, planned and carried out, as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.benchmark_options import Fresh, Jobs, JsonFile, Output, Ray
from pack_bringup.cli.benchmark_run import RunOptions, run


def benchmark(
    blocks: Annotated[int, typer.Option(min=1, max=25, help="Number of blocks of an instance.")] = 9,
    density: Annotated[
        float, typer.Option(min=0.01, max=0.6, help="Share of the workspace that the blocks cover.")
    ] = 0.2,
    instances: Annotated[
        int, typer.Option(min=1, help="Number of instances, with seeds from --seed on.")
    ] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first instance and of its planner.")] = 0,
    problem: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE", help="Solve the problem of this file instead of generated ones; may be repeated."
        ),
    ] = None,
    method: Annotated[
        list[str] | None,
        typer.Option(help="Planner, by its name in config/nodes/blocks/rearrangement.yaml; may be repeated."),
    ] = None,
    price: Annotated[
        str | None,
        typer.Option(help="What beam's plans have least of: actions, or paper (Eq. 1). Default: configured."),
    ] = None,
    budget: Annotated[float, typer.Option(min=0.01, help="Wall clock that a plan may take [s].")] = 1.0,
    execute: Annotated[
        bool, typer.Option("--execute", help="Have the simulated arm carry out every plan.")
    ] = False,
    jobs: Jobs = 1,
    ray: Ray = None,
    output: Output = None,
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
    - `pack benchmark blocks --problem config/scenarios/blocks/example.yaml` plans an own instance
    - `pack benchmark blocks --blocks 4 --instances 100 --execute` has the arm do it
    """
    from pack_core.blocks.cell import blocks_cell
    from pack_lockstep.blocks.benchmark import BlocksBenchmark, BlocksSetup, PlanJob
    from pack_lockstep.blocks.benchmark_instances import wanted_instances
    from pack_lockstep.blocks.settings import lockstep_config
    from pack_planner.rearrangement.methods import DEFAULT_METHOD, METHODS

    methods = list(dict.fromkeys(METHODS.checked(name) for name in method or [DEFAULT_METHOD]))
    found = wanted_instances(blocks, density, range(seed, seed + instances), problem or [])
    wanted = tuple(PlanJob(name, instance) for instance in found for name in methods)
    setup = BlocksSetup(blocks_cell(), lockstep_config(price), budget, execute)
    run(BlocksBenchmark(setup, wanted), RunOptions(jobs, ray, output, fresh, json_file, pictures))
