"""`pack goal packing`: one object packed by a running cell."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.domain_option import Domain
from pack_bringup.cli.goal_run import Reset, run_goal
from pack_bringup.cli.network_option import Network
from pack_core.errors import ConfigError
from pack_core.packing.method import PackingMethod

if TYPE_CHECKING:
    from pack_bringup.packing.goal import PackingGoal

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
        help="Pack in the scene of this file (docs/cells/packing/scenes.md) instead of a generated one.",
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
    typer.Argument(metavar="LIST", help="With --fill: a list file (docs/cells/packing/filling.md)."),
]


def goal(
    seed: Seed = 0,
    scene: SceneFile = None,
    method: Method = PackingMethod.PACK_IT_IN,
    fill: Fill = False,
    given: ListFile = None,
    reset: Reset = True,
    domain: Domain = None,
    network: Network = "",
) -> None:
    """Have a running cell pack one object, or fill its container from a list.

    The exit code is 0 if all was packed, 1 if not, and 2 if the goal was refused. Ctrl-C cancels the goal.

    - `pack goal packing --seed 3`
    - `pack goal packing --scene config/scenarios/packing/example.yaml --domain 7`
    - `pack goal packing --no-reset`, to go on with the scene as it stands
    - `pack goal packing --fill config/packing_lists/example.yaml`
    """
    from pack_bringup.packing.goal import PackingGoal

    if is_fill(fill, given, scene, method):
        run_goal(fill_goal(seed, given), reset=reset, domain=domain, network=network)
    check_scene(scene)
    run_goal(PackingGoal(seed, scene, method.value), reset=reset, domain=domain, network=network)


def fill_goal(seed: int, given: Path | None) -> PackingGoal:
    """The goal of a list file or, without one, of the list that the seed draws; raises ConfigError."""
    from pack_bringup.packing.fill_goal import PackingFillGoal, wanted_list
    from pack_core.packing.cell import packing_cell

    return PackingFillGoal(seed, list_text=wanted_list(seed, given, packing_cell()).to_yaml())


def is_fill(fill: bool, given: Path | None, scene: Path | None, method: PackingMethod) -> bool:
    """Whether a container is to be filled; raises ConfigError for options that do not go with it."""
    if not (fill or given):
        return False
    if scene is not None or method is not PackingMethod.PACK_IT_IN:
        raise ConfigError("--scene or --method beside --fill; allowed: LIST, which has its own container")
    return True


def check_scene(path: Path | None) -> None:
    """Refuse a scene file that cannot be used before anybody is asked to; raises ConfigError."""
    from pack_core.packing.scene_file import load_scene

    if path is not None:
        load_scene(path)
