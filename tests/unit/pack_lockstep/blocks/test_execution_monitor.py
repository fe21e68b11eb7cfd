import numpy as np
import pytest

from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers
from pack_core.blocks.gripper import FingerCommand
from pack_core.motion.moves import Line, Path
from pack_core.rotations import Pose, from_yaw
from pack_core.states import ObjectState, SceneState
from pack_lockstep.blocks.execution import ExecutionMonitor

LIFT = MoveArm(Path((Line(Pose(np.zeros(3)), label="lift"),)), opening=0.05, obstacles=())
LET_GO = MoveFingers(FingerCommand(0.06, 60.0))


def truth(**places: tuple[float, float, float]) -> SceneState:
    states = {name: ObjectState(Pose([x, y, 0.0254], from_yaw(yaw))) for name, (x, y, yaw) in places.items()}
    return SceneState(0.0, states)


def tool(x: float, yaw: float = 0.0) -> Pose:
    return Pose(np.array([x, 0.0, 0.03]), from_yaw(yaw))


def test_slip_is_what_a_block_moves_in_the_hand() -> None:
    monitor = ExecutionMonitor()
    monitor.on_request(LIFT, truth(a=(0.5, 0.0, 0.0)), tool(0.5), "a")
    monitor.on_request(LET_GO, truth(a=(0.7002, 0.0, 0.001)), tool(0.7), "a")
    assert monitor.slips[0].distance == pytest.approx(0.0002)
    assert monitor.slips[0].angle == pytest.approx(0.001)


def test_a_block_that_goes_with_the_hand_does_not_slip() -> None:
    monitor = ExecutionMonitor()
    monitor.on_request(LIFT, truth(a=(0.5, 0.0, 0.0)), tool(0.5), "a")
    monitor.on_request(LET_GO, truth(a=(0.7, 0.0, 0.4)), tool(0.7, 0.4), "a")
    assert monitor.slips[0].distance == pytest.approx(0.0, abs=1e-12)
    assert monitor.slips[0].angle == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("on", "moved"), [("a", 0.003), ("b", 0.1), ("", 0.1)])
def test_a_disturbance_is_the_farthest_way_of_a_block_that_was_not_acted_on(on: str, moved: float) -> None:
    look: ExecutorRequest = Look()
    monitor = ExecutionMonitor()
    monitor.on_request(look, truth(a=(0.5, 0.0, 0.0), b=(0.6, 0.0, 0.0)), tool(0.0), "")
    monitor.on_request(look, truth(a=(0.6, 0.0, 0.0), b=(0.603, 0.0, 0.0)), tool(0.0), on)
    assert monitor.disturbance == pytest.approx(moved)
