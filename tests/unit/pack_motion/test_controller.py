from __future__ import annotations

import numpy as np
import pytest

from pack_core.errors import PackError
from pack_core.joints import JointSample
from pack_core.motion.moves import JointMove, Line, Path, PoseMove
from pack_core.motion.target import MotionState, MotionTarget, ReachTolerance
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.controller import MotionController
from pack_motion.rmpflow.spheres import box_distance
from pack_motion.tracking.config import motion_set
from unit.pack_motion.loop import PERIOD, Loop, pose

HOVER, GOAL, AWAY = pose(-2.5, 2.5, 1.1, 0.1), pose(-2.5, 2.5, 0.9, 0.1), pose(-2.5, 2.3, 1.2, 0.1)
PICK = Path((PoseMove(HOVER, label="transit"), Line(GOAL, entry_speed=0.25, label="down")))


def target(*segments: PoseMove | Line | JointMove, obstacles: tuple[Obstacle, ...] = ()) -> MotionTarget:
    return MotionTarget(7, Path(segments), obstacles=obstacles)


def clearance(loop: Loop, obstacle: Obstacle) -> float:
    """Least distance of the tool's point to a box that stands [m]."""
    box = np.eye(3), obstacle.X_WO.p.copy(), 0.5 * obstacle.size
    return min(box_distance(p, *box)[0] for p in loop.tool)


def test_a_target_is_reached_as_planned_within_all_limits(arm: MotionArm) -> None:
    loop = Loop(arm)
    acceptance = loop.run(MotionTarget(7, PICK))
    status = loop.controller.status()
    assert (status.state, status.id, status.reason) == (MotionState.REACHED, 7, "")
    assert loop.time == pytest.approx(acceptance.duration, abs=4 * PERIOD)
    assert status.position_error < 1e-5
    assert status.path_error < 1e-6
    assert np.all(loop.speeds <= 1.0)
    assert np.all(loop.accelerations <= 1.0)
    assert list(dict.fromkeys(loop.labels)) == ["transit", "down"]


def test_what_is_commanded_stays_on_the_planned_line(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.run(MotionTarget(7, PICK))
    line = loop.tool[[label == "down" for label in loop.labels]]
    assert np.abs(line[:, :2] - GOAL.p[:2]).max() < 2e-5


def test_the_same_commands_give_the_same_setpoints_bit_for_bit(arm: MotionArm) -> None:
    runs = [Loop(arm), Loop(arm)]
    for loop in runs:
        loop.run(MotionTarget(7, PICK))
    np.testing.assert_array_equal(runs[0].q, runs[1].q)


def test_a_new_target_is_taken_up_in_motion_without_a_jump(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.run(MotionTarget(7, PICK), limit=1.0)
    assert np.abs(loop.v[-1]).max() > 0.5
    loop.run(target(PoseMove(AWAY)))
    assert loop.controller.status().state is MotionState.REACHED
    assert np.all(loop.accelerations <= 1.0)


def test_stop_brings_the_arm_to_rest_within_its_limits(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.run(MotionTarget(7, PICK), limit=1.0)
    loop.controller.stop()
    while loop.controller.status().remaining > 0.0:
        loop.step()
    assert np.abs(loop.v[-1]).max() < 1e-3
    assert loop.time < 3.0
    assert np.all(loop.accelerations <= 1.0)


def test_a_refused_target_changes_nothing_but_the_status(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.run(MotionTarget(7, PICK), limit=1.0)
    acceptance = loop.controller.command(target(PoseMove(pose(9.0, 0.0, 1.0), label="far")))
    status = loop.controller.status()
    assert not acceptance.is_accepted
    assert "out of reach" in acceptance.reason
    assert (status.state, status.reason) == (MotionState.REFUSED, acceptance.reason)
    for _ in range(1000):
        loop.step()
    assert np.linalg.norm(loop.tool[-1] - GOAL.p) < 1e-5


def test_an_unclear_path_is_refused_unless_it_is_not_to_be_checked(arm: MotionArm) -> None:
    wall = Obstacle("wall", Pose(np.array([-1.5, 2.9, 1.0])), np.array([0.1, 1.0, 2.0]))
    loop = Loop(arm)
    refused = loop.controller.command(MotionTarget(1, PICK, obstacles=(wall,)))
    assert not refused.is_accepted
    assert "'wall'" in refused.reason
    assert loop.controller.command(MotionTarget(1, PICK, obstacles=(wall,), is_checked=False)).is_accepted


def test_reached_means_measured_errors_within_tolerance_for_so_many_steps(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.controller.command(MotionTarget(7, Path((JointMove(arm.home),)), tolerance=ReachTolerance(steps=5)))
    off = JointSample(0.0, arm.home + np.array([0.002, 0, 0, 0, 0, 0]), np.zeros(6), np.zeros(6))
    on = JointSample(0.0, arm.home, np.zeros(6), np.zeros(6))
    for k, (sample, reached) in enumerate(
        [(off, 0), (on, 1), (on, 2), (off, 0), *((on, n) for n in range(1, 6))]
    ):
        loop.controller.step((k + 1) * PERIOD, sample)
        assert loop.controller.status().reached_steps == reached
    assert loop.controller.status().state is MotionState.REACHED


def test_an_arm_that_does_not_arrive_is_stuck(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.controller.command(target(PoseMove(AWAY)))
    start = JointSample(0.0, arm.home, np.zeros(6), np.zeros(6))
    for k in range(2000):
        loop.controller.step((k + 1) * PERIOD, start)
    status = loop.controller.status()
    assert status.state is MotionState.STUCK
    assert "mm from its target" in status.reason


def test_time_must_go_forward_in_short_steps(arm: MotionArm) -> None:
    loop, sample = Loop(arm), JointSample(0.0, arm.home, np.zeros(6), np.zeros(6))
    for time in (0.0, -1.0, 5.0):
        with pytest.raises(PackError, match="allowed: forward"):
            loop.controller.step(time, sample)


def midway(arm: MotionArm) -> Array:
    """A point that the tool passes on its way."""
    loop = Loop(arm)
    loop.run(target(PoseMove(HOVER)))
    return np.asarray(loop.tool[len(loop.q) // 2])


def test_the_policies_of_the_table_drive_around_an_obstacle_in_the_path(arm: MotionArm) -> None:
    thing = Obstacle(
        "thing", Pose(midway(arm) - np.array([0, 0, 0.15])), np.array([0.15, 0.15, 0.4]), is_moving=True
    )
    loop = Loop(arm, "table_4_1")
    loop.run(target(PoseMove(HOVER), obstacles=(thing,)))
    assert loop.controller.status().state is MotionState.REACHED
    assert clearance(loop, thing) > 0.05


def test_a_tool_that_the_policies_of_the_table_keep_from_its_target_is_stuck(arm: MotionArm) -> None:
    thing = Obstacle("thing", Pose(HOVER.p), np.array([0.4, 0.4, 0.4]), is_moving=True)
    table, loop = motion_set("table_4_1"), Loop(arm)
    impatient = table.model_copy(update={"stuck": table.stuck.model_copy(update={"waiting": 2.0})})
    loop.controller = MotionController(arm, impatient, 0.0, arm.home)
    loop.run(target(PoseMove(HOVER), obstacles=(thing,)), limit=4.0)
    status = loop.controller.status()
    assert status.state is MotionState.STUCK
    assert "held up" in status.reason


def test_the_arm_waits_before_a_wall_in_its_path(arm: MotionArm) -> None:
    wall = Obstacle("wall", Pose(midway(arm)), np.array([0.1, 2.5, 3.0]), is_moving=True)
    loop = Loop(arm)
    loop.run(target(PoseMove(HOVER), obstacles=(wall,)), limit=4.0)
    status = loop.controller.status()
    assert status.state is MotionState.MOVING
    assert "gives way" in status.reason
    assert "wall" in status.reason
    assert clearance(loop, wall) > 0.1


def test_the_literal_table_breaks_the_real_limits_of_the_arm(arm: MotionArm) -> None:
    """The ablation is what it is said to be: fast, and far beyond what the joints can do."""
    loop = Loop(arm, "table_4_1")
    loop.run(target(PoseMove(HOVER)))
    assert loop.controller.status().state is MotionState.REACHED
    assert loop.accelerations.max() > 5.0
    assert loop.speeds.max() > 1.0
