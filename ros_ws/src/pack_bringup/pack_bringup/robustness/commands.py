"""`pack benchmark faults` and `hands`, and `pack soak`: a running cell, and what is not foreseen."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pack_bringup.cli.options import BenchmarkFolder, Fresh, JsonFile, RealTimeFactor, prepare_network
from pack_bringup.cli.outputs import command_line, make_output_folder, write_json
from pack_bringup.cli.terminal import TrialProgress, end_as_by_ctrl_c, show_table
from pack_bringup.robustness.fault_cases import FAULT_COLUMNS, Fault, fault_cases, fault_row

if TYPE_CHECKING:
    from pack_bringup.graph.graph import Graph
    from pack_bringup.graph.processes import ProcessGroup
    from pack_bringup.robustness.ros.cell_observer import CellObserver

LOG = "nodes.log"
GOALS, RECORDING, SOAK, PLOT = "goals.jsonl", "recording", "soak.json", "soak.png"
"""What `pack soak` leaves in its folder besides."""
GOAL_TIMEOUT = 1200.0
"""For a goal of `pack soak` to end [s of wall clock]: several times what the longest takes."""
app = typer.Typer()


def faults(
    cell: Annotated[str, typer.Argument(help="Cell to put faults into, e.g. `packing`.")],
    node: Annotated[list[str] | None, typer.Option(help="Only this node; may be repeated.")] = None,
    fault: Annotated[list[Fault] | None, typer.Option(help="Only this fault; may be repeated.")] = None,
    stage: Annotated[list[str] | None, typer.Option(help="Only in this stage; may be repeated.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the goal that is pursued again and again.")] = 0,
    output: BenchmarkFolder = None,
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
    from pack_core.cells import check_cell

    cases = fault_cases(check_cell(cell), node or (), fault or (), stage or ())
    campaign = Campaign("faults", cell, seed, cases, FAULT_COLUMNS, fault_row, f"Faults in the cell {cell}")
    campaign.run(partial(_injecting, cell, seed), output, json_file, fresh=fresh)


def hands(
    cell: Annotated[str, typer.Argument(help="Cell to reach into, e.g. `palletizing`.")],
    disturbance: Annotated[
        list[str] | None, typer.Option(help="Only this disturbance; may be repeated.")
    ] = None,
    state: Annotated[list[str] | None, typer.Option(help="Only in this state; may be repeated.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of where boxes arrive and of noise.")] = 0,
    output: BenchmarkFolder = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Reach into a cell while it works, in each of its states, and tell what becomes of it.

    Objects are removed, turned, moved, exchanged and added, the vacuum is lost, the camera is silent. It runs
    without ROS on simulated time and repeats bit for bit. The table says what the cell noticed and when, how
    the order or problem ended, and what truly stands where it should.

    A case takes a quarter of a minute; interrupted, the table goes on where it was.

    - `pack benchmark hands palletizing`
    - `pack benchmark hands blocks --disturbance "block removed"`
    """
    from pack_core.cells import cell_part
    from pack_lockstep.disturbances import DISTURBANCE_COLUMNS, chosen, disturbance_row

    table = cell_part(cell, "disturbances")
    cases = chosen(table.cases, what=("disturbance", disturbance or ()), when=("state", state or ()))
    campaign = Campaign(
        "hands", cell, seed, cases, DISTURBANCE_COLUMNS, disturbance_row, f"By hand in the cell {cell}",
        table.note,
    )  # fmt: skip
    campaign.run(lambda _: nullcontext(lambda case: table.run(case, seed)), output, json_file, fresh=fresh)


@dataclass(frozen=True)
class Campaign:
    """Cases that are tried once each, kept as they end, and shown as the rows of a table.

    Attributes:
        kind: what is tried, as files and folders are named.
        cell: in which cell.
        seed: of its goal and its noise.
        cases: dataclasses with a `name`.
        columns: of the table.
        row: a kept report as a row.
        title: of the table.
        note: below it.
    """

    kind: str
    cell: str
    seed: int
    cases: Sequence[Any]
    columns: Sequence[str]
    row: Callable[[Mapping[str, Any]], tuple[str, ...]]
    title: str
    note: str = ""

    def run(
        self, bench: Callable[[Path], AbstractContextManager[Callable[[Any], Any]]], output: Path | None,
        json_file: Path | None, *, fresh: bool,
    ) -> None:  # fmt: skip
        """Try what was not tried yet, print the table, and write all reports as JSON.

        Args:
            bench: opens, in a folder, what makes the report of a case.
            output: the folder; None: one named after kind and cell.
            json_file: takes the reports, too.
            fresh: forget what was tried before.
        """
        from pack_core.paths import bags_path
        from pack_evaluation.provenance import provenance
        from pack_lockstep.benchmarking.benchmark import Verdict
        from pack_lockstep.benchmarking.results_folder import TrialFile

        folder = output or bags_path() / "benchmarks" / f"{self.kind}_{self.cell}"
        file = folder / f"{self.kind}.jsonl"
        make_output_folder(folder)
        if fresh:
            file.unlink(missing_ok=True)
        # The number is that of the cases: a file of other ones is not gone on with.
        settings = {self.kind: "1", "seed": self.seed}
        results = TrialFile(file, self.cell, settings, provenance(command_line()))
        left = [case for case in self.cases if case.name not in results.trials]
        if left:
            with (
                bench(folder) as try_case,
                TrialProgress(len(self.cases), len(self.cases) - len(left)) as bar,
            ):
                for case in left:
                    results.add(asdict(try_case(case)))
                    report = results.trials[case.name]
                    bar.add(Verdict(case.name, not report["problem"], self._line(case, report)))
        kept = [results.trials[case.name] for case in self.cases]
        show_table(self.columns, [self.row(report) for report in kept], title=self.title, note=self.note)
        for path in filter(None, (folder / f"{self.kind}.json", json_file)):
            write_json(path, {"cell": self.cell, "seed": self.seed, "cases": kept})

    def _line(self, case: Any, report: Mapping[str, Any]) -> str:
        """What a row says beyond the case's name."""
        cells = zip(self.columns, self.row(report), strict=True)
        return "; ".join(
            f"{name} {text}".strip() for name, text in cells if text and text not in asdict(case).values()
        )


@contextmanager
def _injecting(cell: str, seed: int, folder: Path) -> Iterator[Callable[[Any], Any]]:
    """A running cell into which faults are injected."""
    from pack_bringup.robustness.ros.fault_injector import FaultInjector
    from pack_core.cells import cell_part

    goal = cell_part(cell, "seeded_goal")(seed)
    recordings = folder / f"recordings_{os.getpid()}"
    overrides = {"recorder": FaultInjector.recorder_parameters(recordings)}
    with _running_cell(cell, overrides, folder / LOG) as (graph, group, observer):
        yield FaultInjector(graph, group, observer, goal, recordings).try_case


@contextmanager
def _running_cell(
    cell: str, overrides: Mapping[str, Mapping[str, str]], log: Path
) -> Iterator[tuple[Graph, ProcessGroup, CellObserver]]:
    """The cell's nodes as processes in a domain of their own, and who listens to them."""
    prepare_network()
    from pack_bringup.graph.graph import load_graph
    from pack_bringup.graph.processes import ProcessGroup
    from pack_bringup.graph.running import check_domain_is_free, choose_domain
    from pack_bringup.robustness.ros.cell_observer import CellObserver

    end_as_by_ctrl_c()  # of a process that stands still nothing else would remain
    graph, domain = load_graph(cell), choose_domain(os.environ)
    check_domain_is_free(domain, cell, [node.name for node in graph.nodes])
    with log.open("a") as output:
        commands = graph.commands(overrides)
        group = ProcessGroup(commands, environment={"ROS_DOMAIN_ID": str(domain)}, output=output)
        with group, CellObserver(cell, domain) as observer:
            yield graph, group, observer


@app.command()
def soak(
    cell: Annotated[str, typer.Argument(help="Cell that runs, e.g. `packing`.")],
    hours: Annotated[float, typer.Option(min=0.0, help="How long goals are sent [h of wall clock].")] = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the first goal; the next has the next.")] = 0,
    real_time_factor: RealTimeFactor = None,
    output: BenchmarkFolder = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Have a cell pursue one goal after the other for hours, and tell what grows meanwhile.

    The nodes run as `pack up` starts them; scenes, orders and problems come from seeds. After each goal the
    memory, threads and descriptors of every node and the machine's shared memory segments are noted. The
    report says how every goal ended, and what grew an hour after the first ten minutes. Ctrl-C ends it early.

    - `pack soak packing --hours 1`
    """
    from pack_bringup.robustness.soak import GROWTH_COLUMNS, growth_table, plot, summary
    from pack_core.cells import check_cell
    from pack_core.paths import bags_path
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.results_folder import TrialFile

    folder = output or bags_path() / "benchmarks" / f"soak_{check_cell(cell)}"
    if fresh:
        shutil.rmtree(folder / RECORDING, ignore_errors=True)
        for name in (GOALS, LOG, SOAK, PLOT):
            (folder / name).unlink(missing_ok=True)
    make_output_folder(folder, taken_by=(GOALS, RECORDING))
    settings = {"soak": hours, "seed": seed, "real_time_factor": real_time_factor}
    goals = TrialFile(folder / GOALS, cell, settings, provenance(command_line()))
    sim = {} if real_time_factor is None else {"real_time_factor": str(real_time_factor)}
    with suppress(KeyboardInterrupt):  # what was measured until then is reported
        _pursue_for(cell, hours, seed, sim, folder, goals)
    samples = list(goals.trials.values())
    if not samples:
        raise typer.Abort
    found = summary(samples)
    show_table(GROWTH_COLUMNS, growth_table(samples), title=f"{found['succeeded']} of {found['goals']} goals")
    plot(samples, folder / PLOT)
    typer.echo(f"plot:   {folder / PLOT}")
    for path in filter(None, (folder / SOAK, json_file)):
        write_json(path, found)
    raise typer.Exit(0 if found["succeeded"] == found["goals"] else 1)


def _pursue_for(cell: str, hours: float, seed: int, sim: Mapping[str, str], folder: Path, goals: Any) -> None:
    from pack_bringup.robustness.soak import HOUR
    from pack_core.cells import cell_part
    from pack_core.errors import PackError

    recorder = {"path": f'"{(folder / RECORDING).resolve()}"', "record": "goals"}
    with _running_cell(cell, {"recorder": recorder, "sim": sim}, folder / LOG) as (graph, group, observer):
        try:
            observer.await_ready([node.name for node in graph.nodes], lambda: group.exit_codes)
        except PackError as error:
            raise PackError(f"{error}; see {folder / LOG}") from error
        began = time.monotonic()
        while time.monotonic() - began < hours * HOUR:
            sample = _pursue(cell_part(cell, "seeded_goal")(seed), observer, group)
            goals.add({"name": f"seed {seed}", "seed": seed, "time": time.monotonic() - began, **sample})
            outcome = "ok" if sample["success"] else f"failed: {sample['message']}"
            typer.echo(f"seed {seed}: {outcome}, {sample['duration']:.0f} s")
            seed += 1


def _pursue(goal: Any, observer: CellObserver, group: ProcessGroup) -> dict[str, Any]:
    """Send a goal, wait for its end, and note what the processes take then."""
    from pack_bringup.robustness.soak import shared_segments, usages
    from pack_core.errors import PackError

    began, simulated, message, success = time.monotonic(), observer.arm.time, "", False
    try:
        observer.send(goal)
        if observer.spin_until(lambda: observer.result is not None, GOAL_TIMEOUT):
            success, message = observer.result.success, observer.result.message
        else:
            message = f"no result in {GOAL_TIMEOUT:.0f} s"
            observer.cancel()
    except PackError as error:
        message = str(error)
    taken = usages({name: group.pid(name) for name in group.running})
    return {
        "success": success, "message": message, "duration": time.monotonic() - began,
        "simulated": observer.arm.time - simulated, "segments": shared_segments(),
        "ended": sorted(group.exit_codes), "nodes": {name: asdict(usage) for name, usage in taken.items()},
    }  # fmt: skip
