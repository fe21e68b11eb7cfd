"""A goal for a cell, and the job of a cell: its nodes as processes, one goal, its recording."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from pack_bringup.graph.bring_up import check_alive, last_words
from pack_bringup.graph.graph import Graph, load_graph
from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.graph.running import check_domain_is_free, choose_domain
from pack_bringup.pace import Pace
from pack_bringup.viewers import PageProcess
from pack_core.errors import PackError
from pack_core.text.reader import load_yaml
from pack_core.used_files import VARIABLE

if TYPE_CHECKING:
    from pack_bringup.ros.goal_client import GoalClient
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class Progress:
    """What is shown while a goal is pursued: the stage it is in, and a line about it."""

    stage: str
    line: str


class CellGoal(Protocol):
    """A goal of one of the cells; pack_bringup/<cell>/goal.py has each cell's."""

    @property
    def cell(self) -> str:
        """A graph of config/graphs."""

    @property
    def server(self) -> str:
        """The node that takes the goal."""

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""

    def reset(self) -> tuple[Contract, Any]:
        """The service that puts a simulated cell into the goal's scene, and its request."""

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""


LOG = "nodes.log"
SIM, FACTOR = "sim", "real_time_factor"
"""The node that owns time, in every cell, and its parameter that says how fast time runs."""
TIMEOUT = 240.0
"""Wall clock for the nodes to come up (a first start compiles), and between two signs of progress [s]."""
LINGER = 2.0
"""Wall clock for which the recording goes on after the goal [s]."""


class Job(CellGoal, Protocol):
    """A goal, and the nodes that are started for it."""

    @property
    def folder(self) -> Path:
        """Of the run; nodes.log, bag/ and run.yaml go there."""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""


class SeededJob(Protocol):
    """Makes the job of a seed: its goal in the folder of a run, with nodes that are started for it."""

    def __call__(
        self, seed: int, folder: Path, *, real_time_factor: float | None, preset: str, command: str
    ) -> Job:
        """The job.

        Args:
            seed: of the goal.
            folder: of the run.
            real_time_factor: None: that of the simulator's parameter file.
            preset: of config/presets/<cell>; empty: the configuration files as they are.
            command: the command line, for run.yaml.

        Raises:
            ConfigError: the cell has no such preset.
        """


def recorder_parameters(job: Job, seed: int, command: str) -> dict[str, str]:
    """The recorder's parameters for a job, as YAML text."""
    # Always: the folder then shows the start, too, and the demo ends shortly after its goal anyhow.
    text = {"path": str(job.folder.resolve()), "cell": job.cell, "command": command, "record": "always"}
    return {"seed": str(seed), **{name: json.dumps(value) for name, value in text.items()}}


def run_demo(
    job: Job,
    on_progress: Callable[[Progress], None],
    domain: int | None = None,
    page: PageProcess | None = None,
    used_files: Path | None = None,
) -> tuple[Any, Pace]:
    """Start the nodes, pursue the goal, stop the nodes; the recording is then complete.

    Args:
        job: the goal, with the nodes' parameters.
        on_progress: is shown where the goal stands, about ten times a second of wall clock.
        domain: ROS domain id; None: the environment's, else a free one.
        page: a page that shows the run while it goes on; None: none.
        used_files: folder into which the nodes tell what they use of the project; None: they do not.

    Returns:
        The action's result, and whether the machine kept up.

    Raises:
        PackError: a node did not come up or died, or the goal was refused; the log's last lines say why.
    """
    from pack_bringup.ros.goal_client import GoalClient, follow_goal

    graph = load_graph(job.cell)
    commands, (contract, goal) = graph.commands(job.overrides()), job.goal()
    commands |= page.commands() if page else {}
    pace = Pace(_wanted_factor(graph, job))
    domain = choose_domain(os.environ) if domain is None else domain
    names = [node.name for node in graph.nodes]
    check_domain_is_free(domain, job.cell, names)
    environment = {"ROS_DOMAIN_ID": str(domain), **(page.environment() if page else {})}
    environment |= {VARIABLE: str(used_files.resolve())} if used_files else {}
    job.folder.mkdir(parents=True, exist_ok=True)
    log = job.folder / LOG
    with log.open("w") as output:
        group = ProcessGroup(commands, environment=environment, output=output)
        patience = _Patience(log, job.server)

        def check(node: GoalClient) -> None:
            nonlocal pace
            check_alive(group, log)
            patience.check(node)
            pace = replace(pace, achieved=node.factors, iterations_ms=node.iterations_ms)
            on_progress(progress_of(job, node, pace))

        with group:
            make = partial(GoalClient, contract, goal, names)
            return follow_goal(make, check, domain=domain, linger=LINGER), pace


def _wanted_factor(graph: Graph, job: Job) -> float:
    """The real-time factor that the simulator is given: the job's, or that of its parameter file."""
    given = job.overrides().get(SIM, {}).get(FACTOR)
    if given is None:
        (sim,) = graph.only((SIM,)).nodes
        given = load_yaml(sim.parameters_path)[SIM]["ros__parameters"][FACTOR]
    return float(given)


class _Patience:
    """Runs out when nothing has changed for `TIMEOUT`."""

    def __init__(self, log: Path, server: str) -> None:
        self._log, self._server = log, server
        self._seen: object = None
        self._deadline = time.monotonic() + TIMEOUT

    def check(self, node: GoalClient) -> None:
        seen = (node.feedback, node.result)
        if seen != self._seen or node.is_paused:
            self._seen, self._deadline = seen, time.monotonic() + TIMEOUT
        if time.monotonic() < self._deadline:
            return
        if missing := node.missing:
            waiting = [f"{name} ({why})" for name, why in missing.items()]
            what, culprit = f"not ready: {', '.join(waiting)}", next(iter(missing))
        elif not node.is_accepted:
            what, culprit = f"node '{self._server}' does not take the goal", self._server
        else:
            what, culprit = f"node '{self._server}' has taken the goal but does not go on", self._server
        raise PackError(f"nothing happened for {TIMEOUT:.0f} s: {what}; {last_words(self._log, culprit)}")


def progress_of(job: CellGoal, node: GoalClient, pace: Pace) -> Progress:
    """Where a goal stands: what it waits for, or the last feedback in words."""
    if node.feedback is not None:
        progress = job.progress(node.feedback, node.real_time_factor)
        return replace(progress, line=progress.line + pace.remark)
    missing = {} if node.is_accepted else node.missing
    return Progress("", f"waiting for {', '.join(missing) or f'node {job.server!r}'}")
