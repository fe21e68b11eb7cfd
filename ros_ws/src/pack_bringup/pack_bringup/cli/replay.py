"""`pack replay`: a node's algorithm on what the node received in a recording."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from pack_bringup.cli.terminal import show_table

if TYPE_CHECKING:
    from pack_lockstep.replay import Replay, Replayer

app = typer.Typer()


@app.command()
def replay(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="A run's or a bag's folder, or an .mcap file.")],
    node: Annotated[
        str,
        typer.Option(
            help="Node whose core is fed: perception or planner (packing), vision or layout (palletizing), "
            "rearrangement or tags (blocks). Default: the first of the recorded cell."
        ),
    ] = "",
    cell: Annotated[str, typer.Option(help="The recorded cell. Default: that of run.yaml.")] = "",
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Seed of the recorded goal, for `planner`. Default: that of run.yaml."),
    ] = None,
    method: Annotated[
        str, typer.Option(help="Method of the recorded goal, for `planner`. Default: pack_it_in.")
    ] = "",
    preset: Annotated[str, typer.Option(help="Preset of the recorded run. Default: that of run.yaml.")] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Calibration of the recorded cell, for `vision` and `perception`."),
    ] = None,
) -> None:
    """Feed what a node received in a recording to its core, and compare its answers with the node's.

    The exit code is 0 only if the core does what the node did. A recording that lacks messages is refused;
    pictures are recorded with `--set recorder.pictures=true`. The nodes mpc, fsm and motion cannot be
    replayed: they move the arm, so that all they receive follows from what they answered before.

    - `pack replay bags/packing_20260101_120000_seed0 --node perception`
    - `pack replay bags/samples/packing --node planner --seed 5`
    - `pack replay bags/samples/palletizing --node layout`
    """
    from pack_bringup.graph.graph import conditions
    from pack_core.cells import cell_part, check_cell
    from pack_evaluation.bag import read_bag
    from pack_evaluation.record import cell_of, load_record
    from pack_lockstep.replay import RunConditions

    recorded_cell, record = check_cell(cell) if cell else cell_of(bag), load_record(bag)
    replayers: dict[str, Replayer] = cell_part(recorded_cell, "replays")
    replayer = _chosen(node or next(iter(replayers)), recorded_cell, replayers)
    under = preset or str(record.get("preset") or "")
    conditions(recorded_cell, under, calibration)
    seed = record.get("seed") if seed is None else seed
    run = RunConditions(under, str(calibration or ""), None if seed is None else int(seed), method)
    found = replayer(read_bag(bag), run)
    show(found)
    raise typer.Exit(0 if found.agrees else 1)


def _chosen(node: str, cell: str, replayers: dict[str, Replayer]) -> Replayer:
    from pack_core.errors import ConfigError

    if node not in replayers:
        raise ConfigError(f"node '{node}' of the cell {cell}; allowed: {', '.join(replayers)}")
    return replayers[node]


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
