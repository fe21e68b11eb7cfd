"""Stopping the arm of the packing cell, and pausing the cell."""

from __future__ import annotations

import numpy as np
import pytest

from integration.harness import Graph
from integration.packing.cell_rig import Cell
from integration.packing.sim_rig import joint_samples, newest_joints, speeds
from integration.simulation_rig import REPORTS, WHO, assert_no_jump, braking_time, pause, play, slowly
from pack_core.robots.panda import PANDA
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp

pytestmark = pytest.mark.usefixtures("nodes_are_given_time")

FACTOR = 0.3
"""Real-time factor at which one process runs four nodes."""
BRAKING = 0.3
"""The arm stands this long after a stop, the time for which the driver waits to be sure included [s]."""


@pytest.fixture
def cell(graph: Graph) -> Cell:
    graph.probe.listen(shared.ARM_STATE, shared.CLOCK)
    return Cell(graph, FACTOR)


def test_a_stop_ends_the_goal_keeps_the_object_and_the_next_goal_moves_the_arm_again(cell: Cell) -> None:
    handle = cell.pack()
    cell.wait_for_motion()
    assert braking_time(cell.graph) < BRAKING
    result = cell.graph.result_of(handle)
    assert (result.success, result.exit_reason) == (False, "fault")
    assert result.message == f"the arm was stopped: {WHO}"
    cell.wait_past(from_stamp(cell.graph.probe.last(shared.ARM_STATE).header.stamp))
    held, counts = newest_joints(cell.graph), cell.sim.health.counts
    refused = counts["refused /joint_torque_setpoints"]  # sent before the stop was heard of
    cell.wait_past(held.time + 0.2)
    np.testing.assert_allclose(newest_joints(cell.graph).q, held.q, atol=2e-3)
    assert cell.sim.simulator.pump.state.is_closed
    with slowly(cell.sim):
        assert cell.pack().accepted
        cell.wait_for_motion()
    assert not cell.graph.probe.last(shared.ARM_STATE).is_stopped
    assert counts["refused /joint_torque_setpoints"] == refused


@pytest.mark.parametrize("stage", ["INSERT", pytest.param("FINE_TUNE", marks=pytest.mark.long)])
def test_a_stop_among_the_objects_keeps_the_object_and_the_next_goal_packs_it(
    graph: Graph, stage: str
) -> None:
    graph.probe.listen(shared.ARM_STATE)
    cell = Cell(graph, FACTOR, settings=["mpc.task.stages.insert_height=0.04"])  # FINE-TUNE has a way to go
    handle = cell.pack()
    cell.graph.wait_until(lambda: cell.feedback and cell.feedback[-1].stage == stage, 60.0)
    assert braking_time(cell.graph) < BRAKING
    assert cell.graph.result_of(handle).message == f"the arm was stopped: {WHO}"
    cell.wait_past(from_stamp(cell.graph.probe.last(shared.ARM_STATE).header.stamp))
    held = newest_joints(cell.graph)
    cell.wait_past(held.time + 0.2)
    np.testing.assert_allclose(newest_joints(cell.graph).q, held.q, atol=2e-3)
    assert cell.sim.simulator.pump.state.is_closed
    result = cell.graph.result_of(cell.pack())
    assert (result.success, result.exit_reason) == (True, "placed"), result.message


def test_a_stop_needs_no_other_node_and_a_reset_ends_it(cell: Cell) -> None:
    cell.pack()
    cell.wait_for_motion()
    for node in (cell.perception, cell.planner):
        cell.graph.stop(node)
    assert braking_time(cell.graph) < BRAKING
    assert cell.graph.call(contracts.RESET, contracts.RESET.type.Request(seed=3)).success
    cell.graph.wait_until(lambda: not cell.graph.probe.last(shared.ARM_STATE).is_stopped)


def test_a_pause_stops_time_and_afterwards_the_goal_goes_on_without_a_jump_or_an_alarm(cell: Cell) -> None:
    handle = cell.pack()
    cell.wait_for_motion()
    pause(cell.graph)
    stands, ticks = cell.time, len(cell.graph.probe.mail[shared.CLOCK.name])
    nodes = (cell.sim, cell.perception, cell.planner, cell.mpc)
    reports = cell.graph.probe.mail[shared.DIAGNOSTICS.name]
    heard = len(reports)
    cell.graph.wait_until(lambda: len(reports) > heard + REPORTS * len(nodes))
    assert cell.time == stands
    assert len(cell.graph.probe.mail[shared.CLOCK.name]) <= ticks + 1  # one may have been on its way
    assert [node.health.faults for node in nodes] == [{}] * len(nodes)
    play(cell.graph)
    cell.wait_past(stands + 0.3)
    samples = joint_samples(cell.graph, stands - 0.1)
    assert_no_jump(samples, stands, PANDA.limits.velocity)
    assert max(speeds(sample).max() for sample in samples if sample.time > stands) > 0.1
    handle.cancel_goal_async()
    assert cell.graph.result_of(handle).exit_reason == "canceled"
