"""What the simulator publishes: its rates, its clock, and what the messages say."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from integration.harness import Graph
from integration.packing.sim_rig import EXAMPLE, SLOW, newest_joints, stamps_of, start_sim
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.packing import from_markers
from pack_core.ros.messages.scene import from_scene


@pytest.mark.parametrize(
    ("contract", "period"),
    [
        (contracts.JOINT_STATES, 0.002), (contracts.WRENCH, 0.004), (contracts.MARKERS, 1 / 120),
        (contracts.TRUTH, 0.008), (contracts.GRIPPER_STATE, 0.02),
    ],
)  # fmt: skip
def test_sensors_speak_at_their_rate_of_simulated_time(
    graph: Graph, contract: Contract, period: float
) -> None:
    start_sim(graph)
    graph.wait_until(lambda: len(graph.probe.mail[contract.name]) > 20)
    gaps = np.diff(stamps_of(graph, contract))
    assert np.median(gaps) == pytest.approx(period, abs=0.001)
    assert np.all(gaps > 0.0)


def test_messages_say_what_the_cell_is_like(graph: Graph) -> None:
    start_sim(graph)
    probe, scene = graph.probe, load_scene(EXAMPLE)
    assert Scene.from_yaml(probe.last(contracts.DESCRIPTION).data) == scene.description()
    np.testing.assert_allclose(newest_joints(graph).q, packing_cell().robot.home, atol=0.01)
    truth = from_scene(probe.last(contracts.TRUTH)).poses()
    assert set(truth) == {*scene.names, scene.new_object.name}
    for name, X_WO in scene.poses().items():
        np.testing.assert_allclose(truth[name].p, X_WO.p, atol=0.002)
    assert set(from_markers(probe.last(contracts.MARKERS)).objects) == set(truth)
    assert probe.last(contracts.GRIPPER_STATE).object == scene.new_object.name
    force = probe.last(contracts.WRENCH).wrench.force
    assert math.hypot(force.x, force.y, force.z) < 0.5


def test_the_clock_runs_as_fast_as_it_is_told(graph: Graph) -> None:
    start_sim(graph)
    graph.probe.listen(shared.REAL_TIME_FACTOR)
    reports = graph.probe.mail[shared.REAL_TIME_FACTOR.name]
    # A busy machine holds it up for a while, and never makes it run faster.
    graph.wait_until(lambda: any(r.data == pytest.approx(SLOW, rel=0.1) for r in reports), timeout=30.0)
    assert max(report.data for report in reports) < 1.1 * SLOW
    clocks = [from_stamp(message.clock) for message in graph.probe.mail[shared.CLOCK.name]]
    assert all(later > earlier for earlier, later in pairwise(clocks))
