from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.motion.moves import SLOW_SPEED, JointMove, Line, Mode, Path, PoseMove, Segment
from pack_core.rotations import Array, Pose, angle_between
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.curve import curve_segments
from pack_motion.reference.joint_move import MoveLimits
from pack_motion.reference.line_run import LineRefused, line_run
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState, MoveRefused, ReferenceTrajectory
from unit.pack_motion.loop import SHARE, pose

ABOVE, ON = pose(-2.5, 2.5, 1.0, 0.1), pose(-2.5, 2.5, 0.8, 0.1)
places = st.tuples(st.floats(-2.9, -2.1), st.floats(2.2, 2.8), st.floats(0.8, 1.6), st.floats(-1.5, 1.5))


def planned(arm: MotionArm, *segments: Segment, q: Array | None = None) -> MotionPlan:
    start = JointState.at_rest(arm.home if q is None else q)
    return PathPlanner(arm, SHARE).plan(start, Path(segments))


def tool(arm: MotionArm, trajectory: ReferenceTrajectory) -> Array:
    return np.array([arm.chain.forward_matrix(q)[1] for q in trajectory.q])


def speeds(arm: MotionArm, rows: ReferenceTrajectory) -> Array:
    """Mean speed of the tool between each row and the next [m/s]."""
    return np.linalg.norm(np.diff(tool(arm, rows), axis=0), axis=1) / np.diff(rows.times)


def assert_is_consistent(arm: MotionArm, rows: ReferenceTrajectory) -> None:
    """Rows are each other's derivatives, within all limits."""
    h = np.diff(rows.times)[:, None]
    mean_v, mean_a = (0.5 * (x[1:] + x[:-1]) for x in (rows.v, rows.a))
    np.testing.assert_allclose(np.diff(rows.q, axis=0) / h, mean_v, atol=2e-3)
    np.testing.assert_allclose(np.diff(rows.v, axis=0) / h, mean_a, atol=0.15)
    assert np.all(np.abs(rows.v) <= arm.limits.velocity)
    assert np.all(np.abs(rows.a) <= arm.limits.acceleration)
    assert np.all(np.diff(rows.times) > 0.0)


@given(place=places)
@settings(max_examples=15)
def test_references_keep_every_joint_limit_and_end_at_the_goal(
    arm: MotionArm, place: tuple[float, ...]
) -> None:
    x, y, z, yaw = place
    goal = pose(x, y, z, yaw)
    plan = planned(arm, PoseMove(pose(x, y, z + 0.2, yaw)), Line(goal, entry_speed=0.25))
    assert_is_consistent(arm, plan.trajectory)
    assert plan.trajectory.end.is_at_rest
    assert np.linalg.norm(plan.X_WT.p - goal.p) < 1e-6
    assert angle_between(plan.X_WT.q, goal.q) < 1e-6


@given(place=places)
@settings(max_examples=6)
def test_pose_moves_in_slow_keep_the_tool_slow(arm: MotionArm, place: tuple[float, ...]) -> None:
    goal = pose(*place)
    plan = planned(arm, PoseMove(goal, mode=Mode.SLOW))
    assert_is_consistent(arm, plan.trajectory)
    assert 0.9 * SLOW_SPEED < speeds(arm, plan.trajectory).max() <= SLOW_SPEED
    assert np.linalg.norm(plan.X_WT.p - goal.p) < 1e-6


def test_a_slow_pose_move_into_a_line_keeps_the_tool_slow(arm: MotionArm) -> None:
    plan = planned(arm, PoseMove(ABOVE, mode=Mode.SLOW), Line(ON, 0.2, entry_speed=0.2))
    assert_is_consistent(arm, plan.trajectory)
    assert speeds(arm, plan.trajectory).max() <= 1.01 * SLOW_SPEED


def test_lines_are_straight_and_keep_the_orientation(arm: MotionArm) -> None:
    plan = planned(arm, PoseMove(ABOVE), Line(ON, entry_speed=0.25))
    line = plan.trajectory.segment == 1
    way = tool(arm, plan.trajectory)[line]
    assert np.abs(way[:, :2] - ON.p[:2]).max() < 1e-6
    assert np.all(np.diff(way[:, 2]) <= 1e-9)
    turned = [angle_between(arm.chain.forward(q).q, ON.q) for q in plan.trajectory.q[line]]
    assert max(turned) < 1e-6


def test_between_rows_the_line_is_straight_too(arm: MotionArm) -> None:
    plan = planned(arm, PoseMove(ABOVE), Line(ON, entry_speed=0.25))
    times = np.arange(plan.trajectory.duration - 0.3, plan.trajectory.duration, 0.0011)
    way = np.array([arm.chain.forward(plan.trajectory.at(t)[0].q).p for t in times])
    assert np.abs(way[:, :2] - ON.p[:2]).max() < 1e-6


def test_the_hover_pose_is_passed_at_the_line_s_speed(arm: MotionArm) -> None:
    plan = planned(arm, PoseMove(ABOVE), Line(ON, acceleration=1.5, entry_speed=0.25))
    first = int(np.argmax(plan.trajectory.segment == 1)) - 1
    q, v = plan.trajectory.q[first], plan.trajectory.v[first]
    rate = arm.chain.jacobian(q) @ v
    np.testing.assert_allclose(rate, [0, 0, -0.25, 0, 0, 0], atol=1e-6)


def test_a_line_is_left_at_its_exit_speed(arm: MotionArm) -> None:
    q = planned(arm, PoseMove(ON)).trajectory.end.q
    plan = planned(arm, Line(ABOVE, acceleration=1.5, exit_speed=0.3), PoseMove(pose(-2.3, 2.3, 1.4)), q=q)
    last = int(np.argmax(plan.trajectory.segment == 1)) - 1
    rate = arm.chain.jacobian(plan.trajectory.q[last]) @ plan.trajectory.v[last]
    np.testing.assert_allclose(rate[:3], [0, 0, 0.3], atol=1e-6)
    assert_is_consistent(arm, plan.trajectory)


def test_a_rounded_corner_is_passed_at_speed_within_its_length(arm: MotionArm) -> None:
    corner, end = pose(-2.5, 2.5, 0.95, 0.1), pose(-2.4, 2.5, 0.90, 0.1)
    lines = Line(corner, exit_speed=0.1, blend=0.02), Line(end, speed=0.1)
    plan = planned(arm, PoseMove(ABOVE), *lines)
    way = tool(arm, plan.trajectory)
    speed = np.linalg.norm(np.diff(way, axis=0), axis=1) / np.diff(plan.trajectory.times)
    nearest = np.linalg.norm(way - corner.p, axis=1).argmin()
    assert 0.0005 < np.linalg.norm(way[nearest] - corner.p) < 0.02
    assert speed[nearest] == pytest.approx(0.1, abs=0.01)
    assert_is_consistent(arm, plan.trajectory)


def test_a_sharp_corner_is_a_stop(arm: MotionArm) -> None:
    corner, end = pose(-2.5, 2.5, 0.95, 0.1), pose(-2.4, 2.5, 0.90, 0.1)
    plan = planned(arm, PoseMove(ABOVE), Line(corner, exit_speed=0.1), Line(end))
    at_corner = int(np.argmax(plan.trajectory.segment == 2)) - 1
    assert np.abs(plan.trajectory.v[at_corner]).max() < 1e-6


def test_poses_in_a_row_are_passed_without_a_stop(arm: MotionArm) -> None:
    via, goal = pose(-1.5, 2.9, 1.5, 0.3), pose(-2.5, 2.4, 1.3, 0.6)
    passing = planned(arm, PoseMove(via), PoseMove(goal)).trajectory
    stopping = planned(arm, PoseMove(via, stop=True), PoseMove(goal)).trajectory
    at_via = int(np.argmax(passing.segment == 1)) - 1
    assert np.linalg.norm(arm.chain.forward(passing.q[at_via]).p - via.p) < 1e-6
    assert np.abs(passing.v[at_via]).max() > 0.1
    assert passing.duration < stopping.duration
    assert_is_consistent(arm, passing)


def beside(arm: MotionArm, step: float) -> Array:
    """The home posture with the first joint turned by a step [rad]."""
    return np.asarray(arm.home + step * np.eye(len(arm.home))[0])


def test_joint_positions_are_passed_at_the_share_of_speed_of_the_moves(arm: MotionArm) -> None:
    moves = JointMove(beside(arm, 0.5), speed=0.2), JointMove(beside(arm, 1.0), speed=0.2)
    rows = planned(arm, *moves).trajectory
    assert np.all(np.abs(rows.v) <= 0.2 * arm.limits.velocity)
    assert np.abs(rows.v[int(np.argmax(rows.segment == 1)) - 1]).max() > 0.05


@pytest.mark.parametrize("step", [0.001, 0.01, 0.1])
def test_no_joint_swings_back_to_pass_what_is_near(arm: MotionArm, step: float) -> None:
    near, far = beside(arm, step), beside(arm, 0.8)
    for moves in ((near, far), (beside(arm, 0.8 - step), far)):
        rows = planned(arm, *map(JointMove, moves)).trajectory
        assert np.all(np.diff(rows.q[:, 0]) > -1e-9)
        stopping = planned(arm, JointMove(moves[0], stop=True), JointMove(moves[1])).trajectory
        assert rows.duration < stopping.duration


def test_slow_moves_in_a_row_keep_the_tool_slow(arm: MotionArm) -> None:
    moves = (JointMove(beside(arm, step), mode=Mode.SLOW) for step in (0.3, 0.6))
    assert speeds(arm, planned(arm, *moves).trajectory).max() <= SLOW_SPEED


@pytest.mark.parametrize("wrist", [0.0, 1e-5, 1e-4])
@pytest.mark.parametrize("name", ["arm", "small_arm"])
def test_a_line_from_a_singular_wrist_is_refused(
    name: str, wrist: float, request: pytest.FixtureRequest
) -> None:
    """Not planned with a minute for 5 cm, nor with rows without end, nor an error of the linear algebra."""
    arm = request.getfixturevalue(name)
    q = arm.home.copy()
    q[4] = wrist
    X_WT = arm.chain.forward(q)
    for way in 0.05 * np.eye(3)[:2]:
        with pytest.raises(MoveRefused, match="singular"):
            planned(arm, Line(Pose(X_WT.p + way, X_WT.q)), q=q)


class Singular:
    """Follows with one joint, whose Jacobian cannot be inverted."""

    def follow_rows(self, R_WT: Array, p_WT: Array, q_start: Array) -> Array:
        return np.tile(q_start, (len(p_WT), 1))

    def joint_rates(self, times: Array, q: Array, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        raise np.linalg.LinAlgError


def test_a_jacobian_that_cannot_be_inverted_is_a_refusal() -> None:
    run = curve_segments(ABOVE, [Line(ON)], 0)
    with pytest.raises(LineRefused, match="singular"):
        line_run(Singular(), run, 0.0, np.zeros(1), MoveLimits(*np.ones((3, 1))))


def test_a_line_from_a_moving_arm_brakes_first(arm: MotionArm) -> None:
    moving = planned(arm, PoseMove(ABOVE)).trajectory.at(0.8)[0]
    plan = PathPlanner(arm, SHARE).plan(moving, Path((PoseMove(ABOVE), Line(ON))))
    np.testing.assert_array_equal(plan.trajectory.v[0], moving.v)
    braking = PathPlanner(arm, SHARE).stop(moving)
    assert braking.end.is_at_rest
    assert_is_consistent(arm, braking)


def test_less_speed_and_acceleration_take_longer(arm: MotionArm) -> None:
    fast, slow = (planned(arm, PoseMove(ABOVE, speed=share, acceleration=share)) for share in (1.0, 0.5))
    assert slow.trajectory.duration > 1.3 * fast.trajectory.duration
    assert np.all(np.abs(slow.trajectory.v) <= 0.5 * arm.limits.velocity)


@pytest.mark.parametrize(
    ("segment", "reason"),
    [
        (PoseMove(pose(9.0, 0.0, 1.0), label="far"), "'far'.*out of reach"),
        (JointMove(np.full(6, 7.0), label="wild"), "'wild'.*allowed"),
        (Line(pose(0.0, -2.5, 0.2), label="beyond"), "'beyond'.*reach"),
    ],
)
def test_what_cannot_be_reached_is_refused_by_name(arm: MotionArm, segment: Segment, reason: str) -> None:
    with pytest.raises(MoveRefused, match=reason):
        planned(arm, segment)


def test_the_small_arm_moves_by_the_same_planner(small_arm: MotionArm) -> None:
    above, on = pose(0.65, 0.0, 0.2, 0.4), pose(0.65, 0.0, 0.05, 0.4)
    plan = planned(small_arm, PoseMove(above), Line(on, speed=0.25, entry_speed=0.1))
    assert_is_consistent(small_arm, plan.trajectory)
    assert np.linalg.norm(plan.X_WT.p - on.p) < 1e-6
