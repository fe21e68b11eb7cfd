import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from block_fsm.executor_config import ExecutorConfig
from block_fsm.motions import Motions
from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.plan import PickPlace, Push
from pack_core.blocks.planar import PlanarPose, wrapped
from pack_core.blocks.problem import CUBES, BlockSize
from pack_core.motion.moves import Line
from pack_core.rotations import rotate, yaw_of
from unit.block_fsm.table import SIDE, TOOL_AT_LOOK

GRIPPER = GripperFootprint()
CONFIG = ExecutorConfig()
MOTIONS = Motions(CONFIG, CUBES, GRIPPER, np.zeros(6), TOOL_AT_LOOK)
angles = st.floats(-np.pi, np.pi)
places = st.builds(PlanarPose, st.floats(0.4, 0.9), st.floats(-0.3, 0.3), angles)


@given(places, places, st.sampled_from([0, 1]))
def test_a_carried_block_arrives_at_its_pose(start: PlanarPose, end: PlanarPose, grasp: int) -> None:
    grip, release = MOTIONS.grasps(PickPlace("a", start, end, grasp))
    turn = yaw_of(release.q) - yaw_of(grip.q)
    assert np.cos(start.yaw + turn - end.yaw) == pytest.approx(1.0)
    assert grip.p[:2] == pytest.approx(start.p)
    assert release.p[:2] == pytest.approx(end.p)
    assert release.p[2] - grip.p[2] == pytest.approx(CONFIG.release_height)


@given(places, places, st.sampled_from([0, 1]))
def test_fingers_close_along_the_planned_axis_pointing_down(
    start: PlanarPose, end: PlanarPose, grasp: int
) -> None:
    action = PickPlace("a", start, end, grasp)
    grip, _ = MOTIONS.grasps(action)
    assert rotate(grip.q, [0, 0, 1]) == pytest.approx([0, 0, -1])
    assert abs(np.cos(yaw_of(grip.q) - action.pick_yaw)) == pytest.approx(1.0)


@given(places, places)
def test_the_wrist_stays_within_half_a_turn_of_its_neutral_heading(
    start: PlanarPose, end: PlanarPose
) -> None:
    action = PickPlace("a", start, end, 0)
    grip, _ = MOTIONS.grasps(action)
    off = wrapped(yaw_of(grip.q) - yaw_of(TOOL_AT_LOOK.q))
    assert abs(off + wrapped(end.yaw - start.yaw)) <= np.pi + 1e-6


@given(places, st.sampled_from([0.0, np.pi / 2, np.pi, -np.pi / 2]), st.floats(0.01, 0.1))
def test_a_push_starts_behind_the_block_and_ends_with_it_at_its_goal(
    goal: PlanarPose, side: float, distance: float
) -> None:
    direction = goal.yaw + side
    push = Push("a", goal.moved(-distance, direction), goal)
    start, end = MOTIONS.pushes(push)
    along = np.array([np.cos(direction), np.sin(direction)])
    reach = SIDE / 2 + GRIPPER.finger_width / 2
    assert (push.start.p - start.p[:2]) @ along == pytest.approx(reach + GRIPPER.push_standoff)
    assert end.p[:2] + reach * along == pytest.approx(goal.p)
    assert abs(rotate(start.q, [1, 0, 0])[:2] @ along) < 1e-9


@given(places, places)
def test_a_carried_block_passes_over_standing_ones(start: PlanarPose, end: PlanarPose) -> None:
    grip, release = MOTIONS.grasps(PickPlace("a", start, end, 0))
    _, across, *_ = MOTIONS.carry(grip, release).segments
    assert isinstance(across, Line)
    bottom = across.X_WT.p[2] - (SIDE - GRIPPER.insertion)
    assert bottom > SIDE + 0.01


SIZES = {"a": BlockSize(0.04, 0.07, 0.045), "b": BlockSize(0.05, 0.05, 0.065)}
OF_MIXED = Motions(CONFIG, SIZES, GRIPPER, np.zeros(6), TOOL_AT_LOOK)


@pytest.mark.parametrize(("turn", "extent"), [(0.0, 0.04), (np.pi / 2, 0.07), (np.pi, 0.04)])
def test_an_oblong_block_is_pushed_from_behind_the_face_that_is_pushed(turn: float, extent: float) -> None:
    goal = PlanarPose(0.6, 0.0, 0.3)
    push = Push("a", goal.moved(-0.05, goal.yaw + turn), goal)
    _, end = OF_MIXED.pushes(push)
    behind = np.hypot(*(end.p[:2] - goal.p))
    assert behind == pytest.approx((extent + GRIPPER.finger_width) / 2)
    assert end.p[2] == pytest.approx(0.045 - GRIPPER.insertion)


@given(places, places)
def test_every_block_passes_over_the_tallest(start: PlanarPose, end: PlanarPose) -> None:
    for block, size in SIZES.items():
        grip, release = OF_MIXED.grasps(PickPlace(block, start, end, 0))
        across = OF_MIXED.carry(grip, release).segments[1]
        assert isinstance(across, Line)
        assert across.X_WT.p[2] - (size.z - GRIPPER.insertion) > 0.065 + 0.01
