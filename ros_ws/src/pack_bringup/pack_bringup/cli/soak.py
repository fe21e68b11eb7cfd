"""`pack soak CELL --hours H`: one goal after the other, and what grows meanwhile."""

from __future__ import annotations

import os
import shutil
import time
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pack_bringup.cli.benchmark_options import Fresh, JsonFile, Output
from pack_bringup.cli.demo_options import RealTimeFactor
from pack_bringup.cli.interrupts import end_as_by_ctrl_c
from pack_bringup.cli.network_option import prepare_network
from pack_bringup.cli.output_folder import make_output_folder
from pack_bringup.soak.soak_report import GROWTH_COLUMNS, HOUR, growth_table, plot
from pack_bringup.soak.soak_report import summary as soak_summary

if TYPE_CHECKING:
    from pack_bringup.faults.ros.fault_witness import FaultWitness
    from pack_bringup.graph.processes import ProcessGroup

app = typer.Typer()
FILE, LOG, SUMMARY, PLOT = "goals.jsonl", "nodes.log", "soak.json", "soak.png"
RECORDING = "recording"
GOAL_TIMEOUT = 1200.0
"""For a goal to end [s of wall clock]."""


@app.command()
def soak(
    cell: Annotated[str, typer.Argument(help="Cell that runs, e.g. `packing`.")],
    hours: Annotated[float, typer.Option(min=0.0, help="How long goals are sent [h of wall clock].")] = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the first goal; the next has the next.")] = 0,
    real_time_factor: RealTimeFactor = None,
    output: Output = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Have a cell pursue one goal after the other for hours, and tell what grows meanwhile.

    The nodes run as `pack up` starts them; scenes, orders and problems come from seeds. After each goal the
    memory, threads and descriptors of every node and the machine's shared memory segments are noted. The
    report says how every goal ended, and what grew an hour after the first ten minutes. Ctrl-C ends it early.

    - `pack soak packing --hours 1`
    """
    from pack_bringup.cli.json_file import write_json
    from pack_bringup.cli.live import command_line
    from pack_bringup.cli.terminal import show_table
    from pack_core.cells import check_cell
    from pack_core.paths import bags_path
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.trial_file import TrialFile

    folder = output or bags_path() / "benchmarks" / f"soak_{check_cell(cell)}"
    if fresh:
        shutil.rmtree(folder / RECORDING, ignore_errors=True)
        for name in (FILE, LOG, SUMMARY, PLOT):
            (folder / name).unlink(missing_ok=True)
    make_output_folder(folder, taken_by=(FILE, RECORDING))
    settings = {"soak": hours, "seed": seed, "real_time_factor": real_time_factor}
    goals = TrialFile(folder / FILE, cell, settings, provenance(command_line()))
    sim = {} if real_time_factor is None else {"real_time_factor": str(real_time_factor)}
    with suppress(KeyboardInterrupt):  # what was measured until then is reported
        _run(cell, hours, seed, sim, folder, goals)
    samples = list(goals.trials.values())
    if not samples:
        raise typer.Abort
    found = soak_summary(samples)
    show_table(GROWTH_COLUMNS, growth_table(samples), title=f"{found['succeeded']} of {found['goals']} goals")
    plot(samples, folder / PLOT)
    typer.echo(f"plot:   {folder / PLOT}")
    for path in filter(None, (folder / SUMMARY, json_file)):
        write_json(path, found)
    raise typer.Exit(0 if found["succeeded"] == found["goals"] else 1)


def _run(cell: str, hours: float, seed: int, sim: dict[str, str], folder: Path, goals: Any) -> None:
    from pack_bringup.faults.ros.fault_witness import FaultWitness
    from pack_bringup.graph.domains import choose_domain
    from pack_bringup.graph.graph import load_graph
    from pack_bringup.graph.processes import ProcessGroup
    from pack_bringup.graph.running import check_domain_is_free
    from pack_core.cells import cell_part
    from pack_core.errors import PackError

    end_as_by_ctrl_c()
    prepare_network()
    graph, domain = load_graph(cell), choose_domain(os.environ)
    check_domain_is_free(domain, cell, [node.name for node in graph.nodes])
    recorder = {"path": f'"{(folder / RECORDING).resolve()}"', "record": "goals"}
    with (folder / LOG).open("a") as log:
        commands = graph.commands({"recorder": recorder, "sim": sim})
        group = ProcessGroup(commands, environment={"ROS_DOMAIN_ID": str(domain)}, output=log)
        with group, FaultWitness(cell, domain) as witness:
            try:
                witness.await_ready([node.name for node in graph.nodes], lambda: group.exit_codes)
            except PackError as error:
                raise PackError(f"{error}; see {folder / LOG}") from error
            began = time.monotonic()
            while time.monotonic() - began < hours * HOUR:
                sample = _pursue(cell_part(cell, "seeded_goal")(seed), witness, group)
                goals.add({"name": f"seed {seed}", "seed": seed, "time": time.monotonic() - began, **sample})
                outcome = "ok" if sample["success"] else f"failed: {sample['message']}"
                typer.echo(f"seed {seed}: {outcome}, {sample['duration']:.0f} s")
                seed += 1


def _pursue(goal: Any, witness: FaultWitness, group: ProcessGroup) -> dict[str, Any]:
    """Send a goal, wait for its end, and note what the processes take then."""
    from pack_bringup.soak.usage import shared_segments, usages
    from pack_core.errors import PackError

    began, simulated, message, success = time.monotonic(), witness.arm.time, "", False
    try:
        witness.send(goal)
        if witness.spin_until(lambda: witness.result is not None, GOAL_TIMEOUT):
            success, message = witness.result.success, witness.result.message
        else:
            message = f"no result in {GOAL_TIMEOUT:.0f} s"
            witness.cancel()
    except PackError as error:
        message = str(error)
    taken = usages({name: group.pid(name) for name in group.running})
    return {
        "success": success, "message": message, "duration": time.monotonic() - began,
        "simulated": witness.arm.time - simulated, "segments": shared_segments(),
        "ended": sorted(group.exit_codes), "nodes": {name: asdict(usage) for name, usage in taken.items()},
    }  # fmt: skip
