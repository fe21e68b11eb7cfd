"""A container filled from a list: by the nodes, and without ROS by the same cores."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from pack_interfaces.action import FillContainer

from integration.harness import Graph
from integration.packing.cell_rig import Cell
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import FillMethod
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.packing_list import PackingList
from pack_core.ros.contracts import packing as contracts
from pack_lockstep.packing.fill_lockstep import FillLockstep
from pack_lockstep.packing.lockstep_config import lockstep_config

FACTOR = 0.3
"""Real-time factor at which one process runs four nodes."""
CAN = Cylinder(name="can", shape="cylinder", radius=0.034, height=0.08, mass=0.3)
CARTON = Box(name="carton", shape="box", size=(0.09, 0.06, 0.1), mass=0.3)
GIANT = Box(name="giant", shape="box", size=(0.3, 0.3, 0.1), mass=0.5)
LIST = PackingList(objects=[CARTON, GIANT, CAN])


def test_objects_are_picked_up_packed_and_let_go_beside_each_other() -> None:
    cell = packing_cell()
    lockstep = FillLockstep(cell, LIST, lockstep_config(), FillMethod.CONTACT, 500)
    report = lockstep.run()
    fates = {row.name: row for row in report.objects}
    assert {name for name, row in fates.items() if row.is_packed} == {"can", "carton"}, report.objects
    assert "0.300 x 0.300" in fates["giant"].reason
    assert fates["giant"].duration == 0.0
    result = lockstep.result()
    assert set(result.truth.inside) == {"can", "carton"}
    assert not result.faults
    lockstep.cell.advance(0.5)
    truth = lockstep.simulator.truth()
    for item in (CAN, CARTON):  # nothing holds them any more, and they stand on the base
        state = truth.objects[item.name]
        assert state.X_WO.p[2] == pytest.approx(item.half_extents[2], abs=0.003)
        assert np.linalg.norm(state.v_WO_W) < 0.01
    assert not lockstep.simulator.pump.state.is_closed
    area = (np.pi * 0.034**2 + 0.09 * 0.06) / np.prod(cell.scene.container.size)
    assert result.truth.fill.base_area == pytest.approx(area, rel=0.01)


@pytest.mark.long
@pytest.mark.timeout(400)
@pytest.mark.parametrize(("preset", "factor"), [("", FACTOR), ("unknown", 0.2)])
def test_the_nodes_fill_a_container_and_report_every_object(
    graph: Graph, tmp_path: Path, preset: str, factor: float
) -> None:
    start = tmp_path / "start.yaml"
    start.write_text(LIST.start(packing_cell()).to_yaml())
    cell, feedback = Cell(graph, factor, start, preset=preset), []
    text = yaml.safe_dump(LIST.model_dump(mode="json", exclude_none=True))
    handle = graph.send_goal(
        contracts.FILL_CONTAINER, FillContainer.Goal(list=text, seed=3),
        feedback=lambda message: feedback.append(message.feedback),
    )  # fmt: skip
    graph.probe.listen(contracts.FILL_PROGRESS)
    result = graph.result_of(handle, timeout=300.0)
    assert (result.exit_reason, result.packed, result.given) == ("done", 2, 3), result.report
    assert not result.success
    assert result.base_area > 0.1
    fates = {row["name"]: row for row in json.loads(result.report)["objects"]}
    assert fates["can"]["packed"]
    assert fates["carton"]["packed"]
    assert not fates["giant"]["packed"]
    assert {"can", "carton"} <= {message.object for message in feedback}
    told = [json.loads(message.data) for message in graph.probe.mail[contracts.FILL_PROGRESS.name]]
    assert {"pick", "pack", "set_down", "release"} <= {row["stage"] for row in told}
    assert [row["name"] for row in told[-1]["objects"]] == list(fates)
    simulator = cell.sim.simulator
    assert set(simulator.scene.names) | {simulator.scene.new_object.name} == {"can", "carton"}


def test_a_list_that_cannot_be_used_is_refused_with_the_reason(graph: Graph, tmp_path: Path) -> None:
    start = tmp_path / "start.yaml"
    start.write_text(LIST.start(packing_cell()).to_yaml())
    Cell(graph, FACTOR, start)
    goal = FillContainer.Goal(list="objects: []")
    assert "objects" in graph.refusal(contracts.FILL_CONTAINER, goal)
    goal = FillContainer.Goal(list=yaml.safe_dump(LIST.model_dump(mode="json", exclude_none=True)))
    goal.method = "magic"
    assert "allowed: contact, no_contact, random" in graph.refusal(contracts.FILL_CONTAINER, goal)
