"""The whole cell but the recorder in one process, on a scene that is packed in seconds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from integration.harness import Graph
from integration.witness import Witness
from pack_bringup.graph.launch import launch_parameters
from pack_core.paths import config_path, project_root
from pack_core.ros.contracts import packing as contracts
from pack_mpc.mpc_node import MpcNode
from pack_perception.mocap.perception_node import PerceptionNode
from pack_planner.placement.planner_node import PlannerNode
from pack_sim.packing.sim_node import PackingSimNode

EASY = project_root() / "tests" / "e2e" / "packing" / "easy_scene.yaml"


def parameters_of(node: str, **changes: Any) -> dict[str, Any]:
    """What `config/nodes/packing/<node>.yaml` gives, by parameter name, and what is to be different."""
    given = yaml.safe_load(config_path("nodes", "packing", f"{node}.yaml").read_text())[node][
        "ros__parameters"
    ]
    return _flat(given) | changes


def _flat(values: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in values.items():
        flat |= _flat(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value}
    return flat


class Cell(Witness):
    """Its nodes, up and ready for a goal, and a witness."""

    def __init__(
        self, graph: Graph, factor: float, scene: Path = EASY, facts: str = "{}", unseen: str = "none",
        preset: str = "", settings: Sequence[str] = (), sim: type[PackingSimNode] = PackingSimNode,
    ) -> None:  # fmt: skip
        super().__init__(graph)
        # Facts lie over config/cells/packing.yaml for all nodes, preset and settings over their own files.
        changes = {
            node: {"cell": facts} | {name: value for name, value in over.items() if name != "use_sim_time"}
            for node, over in launch_parameters("packing", preset, settings).items()
        }
        watched = ["sim", "perception", "planner"]
        self.sim = graph.start(
            sim,
            **parameters_of("sim", scene=str(scene), real_time_factor=factor, **changes["sim"]),
        )
        self.perception = graph.start(PerceptionNode, **parameters_of("perception", **changes["perception"]))
        self.planner = graph.start(PlannerNode, **parameters_of("planner", **changes["planner"]))
        # Four nodes in one process keep each other waiting, the more so on a busy machine.
        self.mpc = graph.start(
            MpcNode, **parameters_of("mpc", watched=watched, fault_time=3.0, **changes["mpc"])
        )
        # what looks and plans may be compiled now
        graph.wait_until(lambda: not self.mpc.waits_for and not self.planner.waits_for, timeout=120.0)
        # With an object unseen a goal begins with a look for it: `unseen` names those that are hidden.
        graph.wait_until(lambda: self.perception.health.values.get("not seen yet") == unseen)
        graph.connect(contracts.JOINT_STATES, subscribers=3)
        graph.connect(contracts.SCENE, subscribers=2)

    @property
    def time(self) -> float:
        """Simulated time, whatever has been heard of it yet [s]."""
        return self.sim.simulator.time
