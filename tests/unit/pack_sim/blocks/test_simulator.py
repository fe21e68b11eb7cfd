import numpy as np
import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import FingerCommand, FingerStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.rotations import angle_between
from pack_sim.blocks.simulator import BlocksSimulator
from unit.pack_sim.blocks.arm import TestArm, tool_down

CELL = blocks_cell()
TAGS = {"a": 0, "b": 1}
STARTS = {"a": PlanarPose(0.6, 0.1, 0.4), "b": PlanarPose(0.7, -0.1, -1.0)}


@pytest.fixture
def simulator() -> BlocksSimulator:
    return BlocksSimulator(CELL, TAGS, STARTS)


def run(simulator: BlocksSimulator, duration: float) -> None:
    for _ in range(round(duration / simulator.config.timestep)):
        simulator.step()


def test_an_arm_that_is_told_nothing_holds_still(simulator: BlocksSimulator) -> None:
    run(simulator, 0.5)
    sample = simulator.joints()
    assert sample.q == pytest.approx(np.array(CELL.robot.look), abs=1e-4)
    assert np.abs(sample.v).max() < 1e-3


def test_blocks_stand_still(simulator: BlocksSimulator) -> None:
    run(simulator, 0.5)
    for name, state in simulator.truth().objects.items():
        assert PlanarPose.of(state.X_WO).distance_to(STARTS[name]) < 1e-5
        assert np.linalg.norm(state.v_WO_W) < 1e-3


def test_tool_follows_a_fast_line_within_a_tenth_of_a_millimetre(simulator: BlocksSimulator) -> None:
    arm = TestArm(CELL, simulator)
    arm.move(tool_down(0.6, -0.2, 0.3, np.pi), 1.6)
    for X_WG, duration in ((tool_down(0.7, 0.2, 0.15, 2.6), 1.2), (tool_down(0.5, 0.0, 0.2, 3.4), 1.0)):
        arm.move(X_WG, duration)
        X_WT = simulator.tool_pose()
        assert np.linalg.norm(X_WT.p - X_WG.p) < 0.1e-3
        assert np.rad2deg(angle_between(X_WT.q, X_WG.q)) < 0.02


def test_a_bad_reference_is_refused(simulator: BlocksSimulator) -> None:
    rows = np.zeros((1, 7))
    with pytest.raises(MessageError, match="shape"):
        simulator.accept(Setpoints(0.0, np.zeros(1), rows, rows, a=rows))


def test_references_that_were_on_their_way_at_a_reset_are_refused() -> None:
    renewed = BlocksSimulator(CELL, TAGS, STARTS, time=52.0)
    rest = np.zeros((1, 6))
    before = np.array([CELL.robot.look]) + 0.5
    with pytest.raises(MessageError, match="from where the arm was held"):
        renewed.accept(Setpoints(52.0, np.zeros(1), before, rest, a=rest))
    run(renewed, 0.2)
    assert renewed.joints().q == pytest.approx(np.array(CELL.robot.look), abs=1e-4)


@pytest.mark.parametrize(
    "command", [FingerCommand(0.09, 60), FingerCommand(-0.01, 60), FingerCommand(0.05, 500)]
)
def test_a_gripper_refuses_what_it_cannot_do(simulator: BlocksSimulator, command: FingerCommand) -> None:
    with pytest.raises(MessageError, match="allowed"):
        simulator.fingers.command(command)


def test_fingers_go_to_an_opening_at_the_stated_speed(simulator: BlocksSimulator) -> None:
    start = simulator.finger_state().opening
    simulator.fingers.command(FingerCommand(start - 0.03, 60.0))
    run(simulator, 0.25)
    assert simulator.finger_state().status is FingerStatus.MOVING
    assert simulator.finger_state().opening == pytest.approx(start - 0.25 * CELL.gripper.speed, abs=0.003)
    run(simulator, 0.6)
    assert simulator.finger_state().status is FingerStatus.AT_OPENING
    assert simulator.finger_state().opening == pytest.approx(start - 0.03, abs=0.0005)


def test_the_same_commands_give_the_same_states() -> None:
    states = []
    for _ in range(2):
        simulator = BlocksSimulator(CELL, TAGS, STARTS)
        simulator.fingers.command(FingerCommand(0.01, 60.0))
        run(simulator, 0.2)
        states.append(simulator.snapshot())
    assert np.array_equal(*states)
