"""The main job: a cell's nodes as processes, one goal, its recording."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pack_bringup.domains import choose_domain
from pack_bringup.graph import load_graph
from pack_bringup.packing.graph_preset import preset_overrides
from pack_bringup.processes import ProcessGroup
from pack_core.config import merged
from pack_core.errors import PackError

if TYPE_CHECKING:
    from pack_interfaces.action import PackObject

    from pack_bringup.goal_node import GoalNode

LOG = "nodes.log"
TIMEOUT = 60.0
"""Wall clock for all nodes to come up and the controller to plan, and between two of its plans [s]."""
LINGER = 2.0
"""Wall clock for which the recording goes on after the goal [s]."""
LOG_LINES = 12


@dataclass(frozen=True)
class Demo:
    """What to run.

    Attributes:
        cell: a graph of config/graphs.
        folder: of the run; nodes.log, bag/, run.yaml and scene.yaml go there.
        seed: of the generated scene, the sensors' noise and the placement planner.
        scene: a scene file; None: a generated scene.
        method: pack_it_in, uninformed_pose or uninformed_physics.
        real_time_factor: None: that of config/nodes/sim.yaml.
        command: the command line, for run.yaml.
        preset: of config/presets; empty: the configuration files as they are.
    """

    cell: str
    folder: Path
    seed: int = 0
    scene: Path | None = None
    method: str = "pack_it_in"
    real_time_factor: float | None = None
    command: str = ""
    preset: str = ""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed)}
        if self.scene is not None:
            sim["scene"] = json.dumps(str(self.scene.resolve()))
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        text = {"path": str(self.folder.resolve()), "cell": self.cell, "command": self.command}
        recorder = {"seed": str(self.seed), **{name: json.dumps(value) for name, value in text.items()}}
        return merged(preset_overrides(self.cell, self.preset), {"sim": sim, "recorder": recorder})


@dataclass(frozen=True)
class Progress:
    """What is shown while the goal is pursued; `stage` is empty until the controller plans."""

    stage: str
    elapsed: float
    distance: float
    iteration_ms: float
    real_time_factor: float
    missing: tuple[str, ...] = ()


def run_demo(demo: Demo, on_progress: Callable[[Progress], None]) -> PackObject.Result:
    """Start the nodes, pursue the goal, stop the nodes; the recording is then complete.

    Raises:
        PackError: a node did not come up or died, or the goal was refused; the log's last lines say why.
    """
    from pack_bringup.goal_node import GoalConfig, follow_goal

    commands = load_graph(demo.cell).commands(demo.overrides())
    domain = choose_domain(os.environ)
    demo.folder.mkdir(parents=True, exist_ok=True)
    log = demo.folder / LOG
    with log.open("w") as output:
        group = ProcessGroup(commands, environment={"ROS_DOMAIN_ID": str(domain)}, output=output)
        patience = _Patience(log)

        def check(node: GoalNode) -> None:
            _check_alive(group, log)
            patience.check(node)
            on_progress(_progress(node))

        with group:
            goal = GoalConfig(method=demo.method, seed=demo.seed)
            return follow_goal(goal, check, domain=domain, linger=LINGER)


def _check_alive(group: ProcessGroup, log: Path) -> None:
    for name, code in group.exit_codes.items():
        raise PackError(f"node '{name}' ended with exit code {code}; {_tail(log, name)}")


class _Patience:
    """Runs out when nothing has changed for `TIMEOUT`."""

    def __init__(self, log: Path) -> None:
        self._log = log
        self._seen: object = None
        self._deadline = time.monotonic() + TIMEOUT

    def check(self, node: GoalNode) -> None:
        seen = (node.feedback, node.result)
        if seen != self._seen:
            self._seen, self._deadline = seen, time.monotonic() + TIMEOUT
        if time.monotonic() < self._deadline:
            return
        if missing := node.missing:
            what, culprit = f"did not come up: {', '.join(missing)}", missing[0]
        elif not node.is_accepted:
            what, culprit = "the controller does not take the goal", "mpc"
        else:
            what, culprit = "the controller has taken the goal but does not plan", "mpc"
        raise PackError(f"nothing happened for {TIMEOUT:.0f} s: {what}; {_tail(self._log, culprit)}")


def _progress(node: GoalNode) -> Progress:
    feedback, factor = node.feedback, node.real_time_factor
    if feedback is None:
        return Progress("", 0.0, 0.0, 0.0, factor, () if node.is_accepted else tuple(node.missing))
    return Progress(feedback.stage, feedback.elapsed, feedback.distance, feedback.iteration_ms, factor)


def _tail(log: Path, name: str) -> str:
    """The last lines of a node in the log."""
    lines = [
        line for line in log.read_text(errors="replace").splitlines() if f" {name} " in line.partition("|")[0]
    ]
    shown = "\n  ".join(lines[-LOG_LINES:]) or "it wrote nothing"
    return f"its last lines in {log}:\n  {shown}"
