"""`pack goal packing`: one object packed by a running cell."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.domain_option import Domain
from pack_bringup.cli.goal_run import Reset, run_goal
from pack_bringup.cli.network_option import Network
from pack_core.packing.method import PackingMethod

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
        help="Pack in the scene of this file (docs/packing/scenes.md) instead of a generated one.",
    ),
]
Method = Annotated[PackingMethod, typer.Option(help="The paper's method, or one of its baselines.")]


def goal(
    seed: Seed = 0,
    scene: SceneFile = None,
    method: Method = PackingMethod.PACK_IT_IN,
    reset: Reset = True,
    domain: Domain = None,
    network: Network = "",
) -> None:
    """Have a running cell pack one object.

    The exit code is 0 if it was packed, 1 if not, and 2 if the goal was refused. Ctrl-C cancels the goal.

    - `pack goal packing --seed 3`
    - `pack goal packing --scene config/scenarios/packing/example.yaml --domain 7`
    - `pack goal packing --no-reset`, to go on with the scene as it stands
    """
    from pack_bringup.packing.goal import PackingGoal

    check_scene(scene)
    wanted = PackingGoal(seed, scene, method.value)
    run_goal(wanted, reset=reset, domain=domain, network=network)


def check_scene(path: Path | None) -> None:
    """Refuse a scene file that cannot be used before anybody is asked to; raises ConfigError."""
    from pack_core.packing.scene_file import load_scene

    if path is not None:
        load_scene(path)
