"""The controller's node in a cell: a goal from acceptance to its result, and what may come between."""

from __future__ import annotations

import gc
import json
import math
from unittest.mock import patch

import numpy as np
import pytest
from pack_interfaces.action import PackObject
from sensor_msgs.msg import JointState

from integration.harness import Graph
from integration.packing.cell_rig import EASY, Cell
from integration.packing.test_lockstep import SEED
from integration.packing.test_lockstep import run as run_in_lockstep
from integration.simulation_rig import pause, play, slowly
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_pose, from_stamp
from pack_core.ros.messages.scene import from_scene
from pack_mpc.ros.mailbox import PERIOD
from pack_mpc.target import Stage

FACTOR = 0.3
"""Real-time factor at which one process runs four nodes."""
STAGES = [stage.name for stage in Stage if stage is not Stage.LOOK]
SETTLED = 0.03
"""A goal ends 15 mm from the packing pose as estimated, with the arm still on its way [m]."""
LIMIT = 0.1
"""The arm is at rest this long after a fault [s of simulated time]."""


@pytest.fixture
def cell(graph: Graph) -> Cell:
    return Cell(graph, FACTOR)


def test_a_goal_is_packed_as_in_lockstep_with_feedback_status_and_a_full_result(cell: Cell) -> None:
    placement = run_in_lockstep(EASY, timeout=0.5).placement
    handle = cell.pack(SEED)
    assert handle.accepted
    result = cell.graph.result_of(handle)
    assert (result.success, result.exit_reason, result.placements) == (True, "placed", 1), result.message
    # Not how long it took: simulated time goes on while a busy machine keeps the nodes from planning.
    assert 0.5 < result.execution_time < 10.0
    assert 0.0 < result.distance < 0.015
    assert 0.0 <= result.force_mean <= result.force_peak
    assert result.iteration_ms > 0.0
    stages = list(dict.fromkeys(message.stage for message in cell.feedback))
    assert stages in (STAGES, STAGES[:2])  # it may be placed the moment it enters the last one
    assert cell.feedback[-1].distance < cell.feedback[0].distance
    statuses = cell.graph.probe.mail[contracts.MPC_STATUS.name]
    assert len(statuses) >= len(cell.feedback)
    planned_from = np.unique([from_stamp(status.header.stamp) for status in statuses])
    assert np.diff(planned_from).min() > PERIOD - 1e-6  # however slowly time runs
    target = from_pose(statuses[-1].target)
    assert target.p[2] == pytest.approx(0.09, abs=0.005)
    assert target.p[2] == pytest.approx(placement.p[2], abs=0.001)
    simulator = cell.sim.simulator
    found = simulator.truth().objects[simulator.scene.new_object.name].X_WO.p
    assert np.linalg.norm(found - target.p) < SETTLED
    cell.graph.wait_until(lambda: cell.graph.probe.last(contracts.RESULT))
    outcome = json.loads(cell.graph.probe.last(contracts.RESULT).data)
    assert outcome["exit_reason"] == result.exit_reason
    assert outcome["execution_time"] == result.execution_time


def test_a_second_goal_is_refused_and_a_canceled_one_ends_at_once_and_the_arm_holds(cell: Cell) -> None:
    handle = cell.pack()
    cell.wait_for_motion()
    assert cell.graph.refusal(contracts.PACK_OBJECT, PackObject.Goal()).startswith("a goal is in progress")
    with slowly(cell.sim):
        asked = cell.time
        handle.cancel_goal_async()
        result = cell.graph.result_of(handle)
        assert (result.success, result.exit_reason) == (False, "canceled")
        cell.wait_past(asked + 3 * LIMIT)
    assert cell.time_to_rest(asked) < LIMIT
    cell.pack()
    cell.wait_for_motion()


def has_heard_all(cell: Cell) -> bool:
    """While time stands: nothing waits in a queue that might overflow."""
    joints = cell.graph.probe.last(contracts.JOINT_STATES)
    return cell.time - from_stamp(joints.header.stamp) < 0.004


def has_refused(cell: Cell, count: int) -> bool:
    """Whether the controller has refused so many joint states and so many scenes."""
    counts = cell.mpc.health.counts
    return all(counts[f"refused {one.name}"] == count for one in (contracts.JOINT_STATES, contracts.SCENE))


def test_joints_and_scenes_that_are_not_finite_are_dropped_and_counted_and_the_goal_goes_on(
    cell: Cell,
) -> None:
    probe, handle = cell.graph.probe, cell.pack()
    cell.graph.wait_until(lambda: cell.feedback and cell.feedback[-1].stage == "INSERT", timeout=60.0)
    pause(cell.graph)
    cell.graph.wait_until(lambda: has_heard_all(cell))
    joints: JointState = probe.last(contracts.JOINT_STATES)
    scene = probe.last(contracts.SCENE)
    joints.position[3], scene.objects[0].pose.position.x = math.nan, math.nan
    for number in range(1, 6):  # one by one, as only the newest is looked at
        probe.send(contracts.JOINT_STATES, joints)
        probe.send(contracts.SCENE, scene)
        cell.graph.wait_until(lambda count=number: has_refused(cell, count))
    play(cell.graph)
    result = cell.graph.result_of(handle)
    assert result.exit_reason == "placed", result.message
    cell.graph.wait_until(lambda: cell.counts_of("mpc").get("refused /scene") == "5")
    counts = cell.counts_of("mpc")
    assert counts["refused /joint_states"] == "5"
    assert "joint position is not finite" in cell.status_of("mpc").message
    assert "failed iteration" not in counts


def test_without_perception_the_arm_holds_and_the_goal_ends_as_a_fault_that_names_it(cell: Cell) -> None:
    handle = cell.pack()
    cell.wait_for_motion()
    died = cell.time
    cell.graph.stop(cell.perception)
    result = cell.graph.result_of(handle)
    assert (result.success, result.exit_reason, result.message) == (False, "fault", "silent: perception")
    assert cell.time_to_rest(died) < LIMIT
    for name in ("mpc", "planner"):
        cell.wait_for_report(name, "'perception' is silent")
    assert cell.graph.refusal(contracts.PACK_OBJECT, PackObject.Goal()) == "silent: perception"


def test_without_the_controller_the_arm_holds(cell: Cell, capfd: pytest.CaptureFixture[str]) -> None:
    cell.pack()
    cell.wait_for_motion()
    cell.graph.stop(cell.mpc)
    gc.collect()  # the goal that nobody pursues any more does nothing when it is thrown away
    assert "Error raised" not in capfd.readouterr().err
    died = cell.time
    cell.wait_past(died + 3 * LIMIT)
    cell.wait_for_report("sim", "'mpc' is silent")
    assert cell.time_to_rest(died) < LIMIT


def test_the_arm_holds_while_the_cameras_see_nothing_and_goes_on_when_they_do(cell: Cell) -> None:
    simulator = cell.sim.simulator
    handle = cell.pack()
    cell.wait_for_motion()
    blinded = cell.time
    with cell.sim.lock:
        config = simulator.mocap.config
        simulator.mocap.config = config.model_copy(update={"min_cameras": 99})
    cell.graph.wait_until(lambda: "seen nothing" in cell.mpc.health.last.get("skipped iteration", ""), 30.0)
    cell.wait_past(blinded + 1.0 + 5 * LIMIT)
    assert cell.time_to_rest(blinded) < 1.0 + 5 * LIMIT
    true, estimated = simulator.truth().objects, from_scene(cell.graph.probe.last(contracts.SCENE)).objects
    for name, item in estimated.items():
        assert item.age > 1.0, name
        assert np.linalg.norm(item.X_WO.p - true[name].X_WO.p) < 0.01, name
    with cell.sim.lock:
        simulator.mocap.config = config
    result = cell.graph.result_of(handle)
    assert result.success, result.message


def test_a_goal_can_be_canceled_while_the_cameras_see_nothing(cell: Cell) -> None:
    handle = cell.pack()
    cell.wait_for_motion()
    with cell.sim.lock:
        mocap = cell.sim.simulator.mocap
        mocap.config = mocap.config.model_copy(update={"min_cameras": 99})
    cell.graph.wait_until(lambda: "seen nothing" in cell.mpc.health.last.get("skipped iteration", ""), 30.0)
    handle.cancel_goal_async()
    assert cell.graph.result_of(handle).exit_reason == "canceled"


def test_a_goal_whose_scene_has_lost_an_object_ends_by_its_time(cell: Cell) -> None:
    handle = cell.pack(timeout=3.0)
    cell.wait_for_motion()
    with patch("pack_mpc.session.unseen_of", lambda *_: ("lost",)):
        assert cell.graph.result_of(handle).exit_reason == "timeout"
    assert "lacks lost" in cell.mpc.health.last["skipped iteration"]


def weigh(cell: Cell, times: float) -> None:
    """Have the held object weigh so many times as much."""
    with cell.sim.lock:
        body = cell.sim.simulator.model.body(cell.sim.simulator.scene.new_object.name)
        body.mass[:] *= times
        body.inertia[:] *= times


def test_a_wrong_load_and_one_that_is_lost_unnoticed_are_named_and_a_right_one_is_not(cell: Cell) -> None:
    weigh(cell, 2.0)
    heavy = cell.graph.result_of(cell.pack())
    assert (heavy.success, heavy.exit_reason) == (False, "fault")
    assert "instead of" in heavy.message
    weigh(cell, 0.5)
    with slowly(cell.sim):  # a busy machine would lose it when it is among the others, where nobody weighs it
        handle = cell.pack()
        cell.wait_for_motion()
        lost_at = cell.time
        weigh(cell, 1e-3)
        lost = cell.graph.result_of(handle)
        took = cell.time - lost_at
    assert (lost.success, lost.exit_reason) == (False, "detached")
    assert "does not hang from it" in lost.message
    assert took < 0.5 + LIMIT
    weigh(cell, 1e3)
    cell.feedback.clear()
    cell.pack()
    cell.graph.wait_until(lambda: cell.feedback and cell.feedback[-1].stage == "INSERT", timeout=60.0)
