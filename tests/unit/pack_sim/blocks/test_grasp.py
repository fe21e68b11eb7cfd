import numpy as np
import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import FingerCommand, FingerStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.rotations import Pose, angle_between
from pack_sim.blocks.simulator import BlocksSimulator
from unit.pack_sim.blocks.arm import TestArm, tool_down

CELL = blocks_cell()
EDGE = CELL.block.edge
GRIP_HEIGHT = EDGE - 0.020
SQUEEZE = FingerCommand(EDGE - 0.010, CELL.gripper.force)
WIDE = FingerCommand(EDGE + 0.008, CELL.gripper.force)


class Scene:
    """A block, and the arm with its fingers around it."""

    def __init__(self, offset_deg: float = 0.0) -> None:
        start = PlanarPose(0.6, -0.1, 0.3)
        self.simulator = BlocksSimulator(CELL, {"a": 0, "b": 1}, {"a": start, "b": PlanarPose(0.8, 0.2, 0.0)})
        self.arm = TestArm(CELL, self.simulator)
        heading = start.yaw + np.pi + np.deg2rad(offset_deg)
        self.arm.move(tool_down(start.x, start.y, 0.15, heading), 2.4)
        self.arm.move(tool_down(start.x, start.y, GRIP_HEIGHT, heading), 0.8)

    def grip(self) -> None:
        self.simulator.fingers.command(SQUEEZE)
        self.arm.wait(0.6)

    def in_hand(self) -> Pose:
        """X_TB of the block."""
        return self.simulator.tool_pose().inverse() @ self.simulator.truth().objects["a"].X_WO


@pytest.fixture
def gripped() -> Scene:
    scene = Scene()
    scene.grip()
    return scene


def test_fingers_that_close_on_a_block_report_that_they_hold_it(gripped: Scene) -> None:
    state = gripped.simulator.finger_state()
    assert state.status is FingerStatus.HOLDING
    assert state.force == pytest.approx(CELL.gripper.force, rel=0.02)
    assert state.opening == pytest.approx(EDGE, abs=0.001)


@pytest.mark.parametrize("offset_deg", [0.0, 0.5])
def test_a_block_slips_less_than_a_fifth_of_a_millimetre_and_degree_when_lifted_carried_and_turned(
    offset_deg: float,
) -> None:
    scene = Scene(offset_deg)
    scene.grip()
    assert scene.simulator.finger_state().status is FingerStatus.HOLDING
    X_TB = scene.in_hand()
    heading = 0.3 + np.pi
    for X_WT, duration in (
        (tool_down(0.6, -0.1, 0.11, heading), 0.8),
        (tool_down(0.75, 0.15, 0.11, heading), 1.4),
        (tool_down(0.75, 0.15, 0.11, heading - np.pi / 2), 1.5),
        (tool_down(0.75, 0.15, GRIP_HEIGHT + 0.001, heading - np.pi / 2), 0.8),
    ):
        scene.arm.move(X_WT, duration)
        now = scene.in_hand()
        assert np.linalg.norm(now.p - X_TB.p) < 0.2e-3
        assert np.rad2deg(angle_between(now.q, X_TB.q)) < 0.2


def test_fingers_that_close_on_nothing_say_so() -> None:
    scene = Scene()
    scene.arm.move(tool_down(0.6, -0.1, 0.15, 0.3 + np.pi), 0.8)
    scene.grip()
    assert scene.simulator.finger_state().status is FingerStatus.AT_OPENING


def test_a_released_block_stays_where_it_was_put(gripped: Scene) -> None:
    before = gripped.simulator.truth().objects["a"].X_WO
    gripped.simulator.fingers.command(WIDE)
    gripped.arm.wait(0.5)
    after = gripped.simulator.truth().objects["a"].X_WO
    assert gripped.simulator.finger_state().status is FingerStatus.AT_OPENING
    assert np.linalg.norm(after.p - before.p) < 0.1e-3
    assert np.rad2deg(angle_between(after.q, before.q)) < 0.05
