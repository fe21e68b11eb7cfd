"""Processor time of a cell's nodes in two versions, side by side: at start, without a goal, and in goals.

`PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.headroom OLD NEW --cell packing` runs the graphs of two
clones that are set up, in turn, and prints for each node the processor time of a simulated second and the
ratio. Only ratios of one run mean something: what else the machine does slows both versions down alike.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Self

import typer
from pack_interfaces.msg import NodeStatus
from rclpy.qos import QoSProfile
from rich.console import Console
from rich.table import Table
from rosgraph_msgs.msg import Clock

from benchmarks.processor_time import processor_time
from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.running import choose_domain
from pack_bringup.ros.status_listener import StatusListener
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp

SETTLING = 15.0
"""From `ready` on until counting begins: what is compiled in the background has ended [s of wall clock]."""
PERIOD = 0.05
"""Between two looks at the clocks [s of wall clock]."""
GOALS = {
    "packing": [["--seed", str(seed)] for seed in (3, 5, 7, 11)],
    "palletizing": [["--order", "config/orders/order_17.json"]],
    "blocks": [["--blocks", "2", "--seed", "3"]],
}
"""What `pack goal` is told, of tuning seeds."""
PURSUES = {"packing": "mpc", "palletizing": "fsm", "blocks": "fsm"}
"""The node that pursues a cell's goals."""
LEFT_OUT = {"packing": ("mpc",), "palletizing": (), "blocks": ()}
"""Nodes that the sum of a goal leaves out: the optimizer takes what time there is."""
PASSED_ON = ("HOME", "USER", "PATH", "LANG", "TMPDIR")
"""Variables that a version gets; all others may be of the version that runs this program."""
Times = dict[str, float]


@dataclass
class Measured:
    """What one run of a graph took.

    Attributes:
        seconds: processor seconds of each node, by part of the run: `start`, `idle`, `goal`.
        simulated: simulated seconds of the parts.
        memory: proportional set size of each node after the goals [MB].
        ready: until every node was ready [s of wall clock].
    """

    seconds: dict[str, Counter[str]] = field(default_factory=dict)
    simulated: Counter[str] = field(default_factory=Counter)
    memory: Times = field(default_factory=dict)
    ready: float = 0.0

    def rates(self, part: str) -> Times:
        """Processor milliseconds of a simulated second by node; of the start, milliseconds."""
        per = 1.0 if part == "start" else self.simulated[part]
        return {name: 1e3 * used / per for name, used in self.seconds.get(part, {}).items()}


class ClockListener(StatusListener):
    """Hears the clock, too, in the same node: a second one would cost the graph a second discovery.

    Attributes:
        time: simulated time as of the last tick that was heard [s].
    """

    time = 0.0

    def __enter__(self) -> Self:
        super().__enter__()
        self._node.create_subscription(Clock, shared.CLOCK.name, self._on_tick, QoSProfile(depth=1))
        return self

    def _on_tick(self, message: Clock) -> None:
        self.time = from_stamp(message.clock)


class RunningGraph:
    """The graph of a clone in a ROS domain, and what its nodes have used so far.

    Args:
        clone: the folder of a version that is set up.
        cell: which graph.
        settings: `node.parameter=value` for `pack up`.
    """

    def __init__(self, clone: Path, cell: str, settings: list[str]) -> None:
        self._clone, self._cell = clone, cell
        self._domain = choose_domain({})
        self._names = [node.name for node in load_graph(cell).nodes]
        self._began = time.monotonic()
        extra = [word for setting in settings for word in ("--set", setting)]
        self._up = self._start(["pack", "up", cell, "--domain", str(self._domain), *extra])
        self._listener = ClockListener(self._domain).__enter__()

    def end(self) -> None:
        """End the graph as Ctrl-C does."""
        self._listener.__exit__(None, None, None)
        self._up.send_signal(signal.SIGINT)
        self._up.wait(30.0)

    def measure_start(self, measured: Measured) -> None:
        """Wait until every node is ready."""
        if not self._listener.spin_until(lambda: not self._listener.unready(self._names), 120.0):
            raise RuntimeError(f"not ready after 120 s: {self._listener.unready(self._names)}")
        measured.ready = time.monotonic() - self._began
        self._pids = node_processes(self._up.pid)
        measured.seconds["start"] = Counter(self._used())

    def measure_idle(self, measured: Measured, duration: float) -> None:
        """Count over `duration` [s of wall clock] without a goal."""
        self._rest(SETTLING)
        before, began = self._used(), self._listener.time
        self._rest(duration)
        self._add(measured, "idle", before, began)

    def measure_goal(self, measured: Measured, options: list[str]) -> None:
        """Send a goal, and count while its node pursues it."""
        busy, goal = PURSUES[self._cell], self._start(
            ["pack", "goal", self._cell, *options, "--domain", str(self._domain)]
        )  # fmt: skip
        before, began = self._used(), self._listener.time
        while goal.poll() is None:
            self._rest(PERIOD)
            if self._listener.statuses[busy].state == NodeStatus.BUSY:
                self._add(measured, "goal", before, began)
            before, began = self._used(), self._listener.time

    def measure_memory(self, measured: Measured) -> None:
        """What each node has in memory, shared pages divided among those that share them."""
        measured.memory = {name: proportional_set_size(pid) for name, pid in self._pids.items()}

    def _add(self, measured: Measured, part: str, before: Times, began: float) -> None:
        used = self._used()
        counted = measured.seconds.setdefault(part, Counter())
        counted.update({name: used[name] - before[name] for name in used})
        measured.simulated[part] += self._listener.time - began

    def _used(self) -> Times:
        return {name: processor_time(pid) for name, pid in self._pids.items()}

    def _rest(self, duration: float) -> None:
        self._listener.spin_until(lambda: False, duration)

    def _start(self, command: list[str]) -> subprocess.Popen[bytes]:
        environment = {name: value for name, value in os.environ.items() if name in PASSED_ON}
        return subprocess.Popen(
            ["bash", "-c", 'source tools/env.sh && exec "$@"', "_", *command],
            cwd=self._clone, env=environment, stdout=subprocess.DEVNULL,
        )  # fmt: skip


def node_processes(parent: int) -> dict[str, int]:
    """Process ids of the nodes that a process has started, by name."""
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(") ")[2].split()
            command = (stat.parent / "cmdline").read_text()
        except OSError:
            continue  # it has just ended
        if int(fields[1]) == parent and "__node:=" in command:
            found[command.partition("__node:=")[2].partition("\0")[0]] = int(stat.parent.name)
    return found


def proportional_set_size(pid: int) -> float:
    """Memory of a process, shared pages divided among those that share them [MB]."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1e3


@contextmanager
def running(clone: Path, cell: str, settings: list[str]) -> Iterator[RunningGraph]:
    """A clone's graph for the time of a `with` block."""
    graph = RunningGraph(clone, cell, settings)
    try:
        yield graph
    finally:
        graph.end()


def measure(clone: Path, cell: str, settings: list[str], duration: float, goals: int) -> Measured:
    """Run a clone's graph once and count."""
    measured = Measured()
    with running(clone, cell, settings) as graph:
        graph.measure_start(measured)
        graph.measure_idle(measured, duration)
        for options in GOALS[cell][:goals]:
            graph.measure_goal(measured, options)
        graph.measure_memory(measured)
    return measured


def rows(old: list[Measured], new: list[Measured], cell: str) -> dict[str, dict[str, tuple[float, float]]]:
    """Means over the rounds of the old and of the new version, by part and node; `memory` is a part, too."""
    found: dict[str, dict[str, tuple[float, float]]] = {}
    for part in ("start", "idle", "goal", "memory"):
        both = [[run.memory if part == "memory" else run.rates(part) for run in runs] for runs in (old, new)]
        if not both[0][0]:
            continue
        means = [{name: sum(run[name] for run in runs) / len(runs) for name in runs[0]} for runs in both]
        table = {name: (means[0][name], means[1].get(name, 0.0)) for name in means[0]}
        table["sum"] = tuple(sum(mean.values()) for mean in means)  # type: ignore[assignment]
        if part == "goal" and LEFT_OUT[cell]:
            kept = [[used for name, used in mean.items() if name not in LEFT_OUT[cell]] for mean in means]
            table[f"sum but {', '.join(LEFT_OUT[cell])}"] = (sum(kept[0]), sum(kept[1]))
        found[part] = table
    found["ready"] = {"wall clock [ms]": tuple(1e3 * sum(r.ready for r in v) / len(v) for v in (old, new))}  # type: ignore[dict-item]
    return found


UNITS = {
    "start": "start until ready [ms of processor time]", "ready": "start until ready",
    "idle": "without a goal [ms of processor time a simulated second]",
    "goal": "in goals [ms of processor time a simulated second]", "memory": "memory [MB]",
}  # fmt: skip


def main(
    old: Annotated[Path, typer.Argument(help="A clone that is set up.")],
    new: Annotated[Path, typer.Argument(help="Another one.")],
    cell: str = "packing",
    rounds: Annotated[int, typer.Option(help="Runs of each version, in turn.")] = 2,
    duration: Annotated[float, typer.Option(help="Without a goal [s of wall clock].")] = 10.0,
    goals: Annotated[int, typer.Option(help="Goals of each run.")] = 2,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NODE.PARAM=VALUE")] = None,
    output: Annotated[Path | None, typer.Option(help="Takes the figures as JSON.")] = None,
) -> None:
    """Compare the processor time of two versions of a cell."""
    runs: tuple[list[Measured], list[Measured]] = ([], [])
    for _ in range(rounds):
        for clone, measured in zip((old, new), runs, strict=True):
            measured.append(measure(clone, cell, settings or [], duration, goals))
    found = rows(*runs, cell)
    for part, table in found.items():
        shown = Table("node", "old", "new", "new / old", title=f"{cell}, {UNITS[part]}")
        for name, (before, after) in table.items():
            ratio = f"{after / before:.2f}" if before else ""
            shown.add_row(name, f"{before:.0f}", f"{after:.0f}", ratio)
        Console().print(shown)
    if output is not None:
        report: dict[str, Any] = {"cell": cell, "rounds": rounds, "goals": goals, "rows": found}
        output.write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    typer.run(main)
