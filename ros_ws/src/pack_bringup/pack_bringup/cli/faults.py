"""`pack benchmark faults CELL`: each node killed, frozen and restarted in each stage of a goal."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pack_bringup.cli.benchmark_options import Fresh, JsonFile, Output
from pack_bringup.cli.interrupts import end_as_by_ctrl_c
from pack_bringup.cli.network_option import prepare_network
from pack_bringup.cli.output_folder import make_output_folder
from pack_bringup.faults.fault import FAULT_COLUMNS, Fault, fault_cases, fault_row

if TYPE_CHECKING:
    from pack_bringup.faults.ros.fault_bench import FaultBench

FILE, LOG, SUMMARY = "faults.jsonl", "nodes.log", "faults.json"


def faults(
    cell: Annotated[str, typer.Argument(help="Cell to put faults into, e.g. `packing`.")],
    node: Annotated[list[str] | None, typer.Option(help="Only this node; may be repeated.")] = None,
    fault: Annotated[list[Fault] | None, typer.Option(help="Only this fault; may be repeated.")] = None,
    stage: Annotated[list[str] | None, typer.Option(help="Only in this stage; may be repeated.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the goal that is pursued again and again.")] = 0,
    output: Output = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Put faults into a running cell, one after the other, and tell what becomes of it.

    The nodes run as `pack up` starts them, at the real-time factor of their configuration. In each case a
    goal is sent; once it is in the stage, the node's process is killed, stopped for 5 s, or killed and
    started again. The table says when the arm began to brake and when it stood [s of simulated time], whether
    the gripper kept what it held, who named the node, how the goal ended, whether the next goal works with no
    other node restarted, and how much a killed recorder's bag lacks.

    A case takes 10 s to a minute of wall clock; interrupted, it goes on where it was.

    - `pack benchmark faults packing`
    - `pack benchmark faults palletizing --node fsm --fault kill`
    """
    from pack_bringup.cli.json_file import write_json
    from pack_bringup.cli.live import command_line
    from pack_bringup.cli.terminal import show_table
    from pack_core.cells import check_cell
    from pack_core.paths import bags_path
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.trial_file import TrialFile

    cases = list(fault_cases(check_cell(cell), node or (), fault or (), stage or ()))
    folder = output or bags_path() / "benchmarks" / f"faults_{cell}"
    make_output_folder(folder)
    if fresh:
        (folder / FILE).unlink(missing_ok=True)
    results = TrialFile(folder / FILE, cell, {"faults": "1", "seed": seed}, provenance(command_line()))
    left = [case for case in cases if case.name not in results.trials]
    if left:
        with running_bench(cell, seed, folder) as bench:
            for k, case in enumerate(left):
                report = bench.try_case(case)
                results.add(asdict(report))
                typer.echo(f"{k + 1}/{len(left)} {_line(results.trials[case.name])}")
    kept = [results.trials[case.name] for case in cases]
    show_table(FAULT_COLUMNS, [fault_row(report) for report in kept], title=f"Faults in the cell {cell}")
    for path in filter(None, (folder / SUMMARY, json_file)):
        write_json(path, {"cell": cell, "seed": seed, "cases": kept})


@contextmanager
def running_bench(cell: str, seed: int, folder: Path) -> Iterator[FaultBench]:
    """The cell's nodes as processes in a domain of their own, and who puts faults into them."""
    from pack_bringup.faults.ros.fault_bench import FaultBench
    from pack_bringup.faults.ros.fault_witness import FaultWitness
    from pack_bringup.graph.domains import choose_domain
    from pack_bringup.graph.graph import load_graph
    from pack_bringup.graph.processes import ProcessGroup
    from pack_bringup.graph.running import check_domain_is_free
    from pack_core.cells import cell_part

    end_as_by_ctrl_c()  # of a process that stands still nothing else would remain
    prepare_network()
    graph, domain = load_graph(cell), choose_domain(os.environ)
    check_domain_is_free(domain, cell, [node.name for node in graph.nodes])
    goal = cell_part(cell, "seeded_goal")(seed)
    recordings = folder / f"recordings_{os.getpid()}"
    with (folder / LOG).open("a") as log:
        overrides = {"recorder": FaultBench.recorder_parameters(recordings)}
        group = ProcessGroup(
            graph.commands(overrides), environment={"ROS_DOMAIN_ID": str(domain)}, output=log
        )
        with group, FaultWitness(cell, domain) as witness:
            yield FaultBench(graph, group, witness, goal, recordings)


def _line(report: dict[str, Any]) -> str:
    cells = zip(FAULT_COLUMNS, fault_row(report), strict=True)
    return "; ".join(f"{name} {text}".strip() for name, text in cells if text)
