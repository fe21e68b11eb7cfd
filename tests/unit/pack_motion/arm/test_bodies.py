import mujoco
import numpy as np
import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.model import arm_model
from pack_core.robots import robotiq_2f85
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS, thickness_at
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm

OPENING = 0.0588


def in_tool(arm: MotionArm, opening: float) -> tuple[Array, Array]:
    """Lower and upper corners `(k, 3)` of the fingers' boxes in the tool's frame, whose axes they share."""
    fingers = arm.fingers
    assert fingers is not None
    boxes, R_TW = fingers.at(opening), arm.chain.R_WT.T
    centres = (boxes.p - arm.chain.p_WT) @ R_TW.T
    half = np.abs(np.einsum("ij,kjl->kil", R_TW, boxes.R)) @ boxes.half[:, :, None]
    return centres - half[:, :, 0], centres + half[:, :, 0]


def test_between_open_fingers_there_is_just_the_opening(small_arm: MotionArm) -> None:
    lower, upper = in_tool(small_arm, OPENING)
    right, left = lower[:, 0] >= 0, upper[:, 0] <= 0
    assert np.all(right | left)
    assert lower[right, 0].min() == pytest.approx(OPENING / 2, abs=1e-6)
    assert upper[left, 0].max() == pytest.approx(-OPENING / 2, abs=1e-6)


def test_boxes_are_as_thick_as_the_finger_slopes(small_arm: MotionArm) -> None:
    lower, upper = in_tool(small_arm, OPENING)
    for height in (0.001, 0.01, 0.02, 0.03):
        around = (upper[:, 0] > 0) & (lower[:, 2] <= -height) & (upper[:, 2] >= -height)
        thickness = upper[around, 0].max() - OPENING / 2
        assert thickness_at(height) <= thickness + 1e-9
        assert thickness <= thickness_at(height + 0.002) + 1e-9


def test_boxes_beside_a_block_fit_into_the_room_that_the_planner_gives_them(small_arm: MotionArm) -> None:
    footprint = GripperFootprint()
    _, upper = in_tool(small_arm, footprint.grasp_opening(0.0508))
    beside = (upper[:, 0] > 0) & (-upper[:, 2] < footprint.insertion - 1e-6)
    assert upper[beside, 0].max() <= 0.0254 + footprint.slab_thickness - 0.001
    assert upper[beside, 1].max() <= footprint.slab_width / 2


def test_every_point_of_the_fingers_is_in_a_box(small_arm: MotionArm) -> None:
    model = arm_model(blocks_cell())
    data = mujoco.MjData(model)
    for name in FINGER_JOINTS:
        data.joint(name).qpos = OPENING / 2
    mujoco.mj_kinematics(model, data)
    lower, upper = in_tool(small_arm, OPENING)
    tool, rng = data.body("tool"), np.random.default_rng(0)
    mesh = model.mesh("finger_wedge")
    first, count = int(mesh.vertadr[0]), int(mesh.vertnum[0])
    vertices = model.mesh_vert[first : first + count]
    for name in robotiq_2f85.TIPS:
        shares = rng.dirichlet(np.ones(count), 200)
        geom = data.geom(name)
        points = geom.xpos + (shares @ vertices) @ geom.xmat.reshape(3, 3).T
        points = (points - tool.xpos) @ tool.xmat.reshape(3, 3)
        inside = (points[:, None] >= lower - 1e-6) & (points[:, None] <= upper + 1e-6)
        assert np.all(inside.all(axis=2).any(axis=1))
