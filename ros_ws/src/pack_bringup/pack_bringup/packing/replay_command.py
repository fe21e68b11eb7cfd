"""`pack replay`: a core on a recording's inputs, against the recording's outputs."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from pack_bringup.cli.terminal import show_table

if TYPE_CHECKING:
    from pack_lockstep.packing.replay.comparison import Replay

app = typer.Typer()


class Node(Enum):
    """Nodes whose cores can be replayed."""

    PERCEPTION = "perception"
    PLANNER = "planner"


@app.command()
def replay(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="A run's or a bag's folder, or an .mcap file.")],
    node: Annotated[Node, typer.Option(help="Node whose core is fed.")] = Node.PERCEPTION,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of the recorded goal. Default: that of run.yaml.")
    ] = None,
    method: Annotated[str, typer.Option(help="Method of the recorded goal, for the planner.")] = "pack_it_in",
    preset: Annotated[
        str, typer.Option(help="Preset of the recorded run. Default: that of run.yaml, or `ideal`.")
    ] = "",
) -> None:
    """Feed what a node of the packing cell received in a recording to its core, and compare the answers.

    Messages are counted first: a recording that lacks some is refused. The exit code is 0 only if the core
    does what the node did.

    - `pack replay bags/packing_20260101_120000_seed0 --node perception`
    - `pack replay bags/samples/packing --node planner --seed 5`
    """
    from pack_core.errors import BagError
    from pack_core.packing.method import PackingMethod
    from pack_evaluation.bag import read_bag
    from pack_evaluation.record import cell_of, load_record
    from pack_lockstep.packing.presets import load_preset
    from pack_lockstep.packing.replay.perception import replay_perception
    from pack_lockstep.packing.replay.planner import replay_planner

    if (cell := cell_of(bag)) != "packing":
        raise BagError(f"{bag} is of the cell {cell}; only nodes of the packing cell can be replayed")
    recorded, chosen = read_bag(bag), PackingMethod.of(method)
    conditions = load_preset(preset or str(load_record(bag).get("preset") or "ideal"))
    if node is Node.PERCEPTION:
        found = replay_perception(recorded, conditions)
    else:
        given = _seed_of(bag) if seed is None else seed
        found = replay_planner(recorded, seed=given, method=chosen, preset=conditions)
    show(found)
    raise typer.Exit(0 if found.agrees else 1)


def show(found: Replay) -> None:
    """Print what went in and how far apart the answers are."""
    typer.echo(f"fed in: {', '.join(f'{count} of {topic}' for topic, count in found.inputs.items())}")
    head = ("", "compared", "mean [mm]", "difference [mm]", "allowed [mm]", "")
    rows = []
    for row in found.rows:
        verdict = Text("agrees", "green") if row.agrees else Text("differs", "red")
        values = (f"{row.mean_mm:.3f}", f"{row.difference_mm:.3f}", f"{row.limit_mm:g}")
        rows.append((row.name, str(row.compared), *values, verdict))
    show_table(head, rows)


def _seed_of(bag: Path) -> int:
    """The seed in the run's record.

    Raises:
        BagError: there is none.
    """
    from pack_core.errors import BagError
    from pack_evaluation.record import load_record

    seed = load_record(bag).get("seed")
    if seed is None:
        raise BagError(f"no run.yaml beside {bag} says the goal's seed; give --seed")
    return int(seed)
