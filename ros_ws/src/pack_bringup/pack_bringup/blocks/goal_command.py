"""`pack goal blocks`: blocks put into a dense grid by a running cell."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.domain_option import Domain
from pack_bringup.cli.goal_run import Reset, run_goal
from pack_bringup.cli.network_option import Network
from pack_core.errors import ConfigError

Blocks = Annotated[int, typer.Option(min=1, max=25, help="Number of blocks.")]
Density = Annotated[
    float, typer.Option(min=0.01, max=0.4, help="Share of the workspace that the blocks cover.")
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the generated problem and of the planner.")]
ProblemFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Solve the problem of this file instead of a generated one."),
]
Method = Annotated[str, typer.Option(help="Planner, by its name in config/nodes/blocks/rearrangement.yaml.")]


def goal(
    blocks: Blocks = 9,
    density: Density = 0.2,
    seed: Seed = 0,
    problem: ProblemFile = None,
    method: Method = "",
    reset: Reset = True,
    domain: Domain = None,
    network: Network = "",
) -> None:
    """Have a running cell rearrange blocks into a dense grid.

    The exit code is 0 if every block is at its goal, 1 if not, and 2 if the goal was refused. Ctrl-C cancels
    the goal.

    - `pack goal blocks --blocks 4 --seed 3`
    - `pack goal blocks --problem config/scenarios/blocks/example.yaml --domain 7`
    """
    from pack_bringup.blocks.goal import BlocksGoal

    wanted = BlocksGoal(problem_of(problem, blocks, density, seed), seed, method)
    run_goal(wanted, reset=reset, domain=domain, network=network)


def problem_of(file: Path | None, blocks: int, density: float, seed: int) -> str:
    """The text of a problem file, or of a generated problem where there is no file.

    Raises:
        ConfigError: there is no such file, it is no problem file, or the problem contradicts itself.
    """
    return _generated(blocks, density, seed) if file is None else _text_of(file)


def _text_of(path: Path) -> str:
    from pack_core.blocks.cell import blocks_cell
    from pack_core.blocks.problem_file import parse_problem
    from pack_core.text.reader import read_text
    from pack_planner.rearrangement.validation import find_fault

    text = read_text(path)
    # Now, because the planner would find it only after all nodes have started.
    if contradiction := find_fault(parse_problem(text, str(path), blocks_cell())):
        raise ConfigError(f"{path}: {contradiction.text}")
    return text


def _generated(blocks: int, density: float, seed: int) -> str:
    from pack_core.blocks.cell import blocks_cell
    from pack_core.blocks.problem_file import problem_text
    from pack_planner.rearrangement.instances import make_instance

    return problem_text(make_instance(blocks, density, seed, centre=blocks_cell().workspace.centre))
