"""Calibrations as goals of the machine's node: what is refused, what is begun, and what ends them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pack_interfaces.action import CalibrateCell
from pack_interfaces.msg import ArmState

from integration.harness import Graph
from pack_core.camera import LensDistortion
from pack_core.joints import JointSample
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.calibration import CalibratedCamera, CellCalibration, PlacingError
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.palletizing.imperfections import NOWHERE, Displacement
from pack_core.robots.joint_properties import GearCompensation
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion as motion_contracts
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.motion import to_status
from pack_core.ros.messages.palletizing import to_gripper_state
from pack_core.rotations import POINTING_DOWN, Pose
from pack_planner.layout.layout_node import LayoutNode
from pallet_fsm.fsm_node import PalletFsmNode

FAULT_TIME = 0.5
"""Silence of a node that ends a goal [s]."""


OLD = CellCalibration(
    preset="real",
    camera=CalibratedCamera(
        displacement=NOWHERE, focal_scale=1.0, centre_shift=(0.0, 0.0), lens=LensDistortion()
    ),
    picking_table=Displacement(shift=(0.003, 0.0, 0.0)), reorientation_table=NOWHERE, pallet=NOWHERE,
    gears=GearCompensation(stiffness=(4e6, 4e6, 2.5e6, 6e5, 6e5, 3e5), backlash_deg=0.008),
    predicted=PlacingError(mean=0.2, p95=0.4), simulated_s=280.0, estimates=(), covariance=(), residuals=(),
)  # fmt: skip
"""A calibration that a cell was started with."""


def started(graph: Graph, preset: str, calibration: str = "") -> PalletFsmNode:
    """The machine under a preset, and the layout; the probe speaks for arm and gripper."""
    graph.probe.listen(motion_contracts.MOTION_TARGET, contracts.PALLET_STATE)
    graph.start(LayoutNode)
    node = graph.start(
        PalletFsmNode, watched=["layout"], fault_time=FAULT_TIME, preset=preset, calibration=calibration
    )
    graph.connect(motion_contracts.MOTION_STATUS, contracts.GRIPPER_STATE)
    tell(graph)
    graph.wait_until(lambda: not node.waits_for or tell(graph))
    return node


def tell(graph: Graph, time: float = 1.0) -> None:
    """Speak for arm and gripper, once."""
    X_WT = Pose(np.array([0.0, 0.5, 2.0]), POINTING_DOWN)
    status = MotionStatus(time, 0, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", X_WT)
    sample = JointSample(time, arm_kinematics().home, np.zeros(6), np.zeros(6))
    graph.probe.send(contracts.GRIPPER_STATE, to_gripper_state(time, GripState(reason=ASKED)))
    graph.probe.send(motion_contracts.MOTION_STATUS, to_status(status))
    graph.probe.send(motion_contracts.JOINT_STATES, to_joint_state(sample, JOINTS))


@pytest.mark.parametrize(
    ("preset", "check", "reason"),
    [
        ("rigid", False, "has no errors of arm and camera to calibrate"),
        ("real", True, "started without a calibration"),
    ],
)
def test_what_cannot_be_done_is_answered_with_the_reason_and_nothing_moves(
    graph: Graph, preset: str, check: bool, reason: str
) -> None:
    started(graph, preset)
    result = graph.result_of(graph.send_goal(contracts.CALIBRATE, CalibrateCell.Goal(check=check)))
    assert not result.success
    assert reason in result.message
    assert graph.probe.mail[motion_contracts.MOTION_TARGET.name] == []


def test_a_cell_that_was_started_with_a_calibration_is_calibrated_anew(graph: Graph, tmp_path: Path) -> None:
    """As one that was not: from the cell on paper, since what has drifted is not where it was found once."""
    OLD.write(tmp_path / "calibration.yaml")
    started(graph, "real", str(tmp_path / "calibration.yaml"))
    told = list[Any]()
    handle = graph.send_goal(contracts.CALIBRATE, CalibrateCell.Goal(), told.append)
    targets = graph.probe.mail[motion_contracts.MOTION_TARGET.name]
    graph.wait_until(lambda: (targets and told) or tell(graph))
    assert targets[0].segments
    assert told[0].feedback.state == "touch surfaces"
    handle.cancel_goal_async()
    graph.wait_until(lambda: not targets[-1].segments or tell(graph))
    result = graph.result_of(handle)
    assert (result.success, result.message) == (False, "canceled on request")


def cancel(_: Graph, __: PalletFsmNode, handle: Any) -> None:
    handle.cancel_goal_async()


def stop(graph: Graph, _: PalletFsmNode, __: Any) -> None:
    graph.connect(shared.ARM_STATE)
    graph.probe.send(shared.ARM_STATE, ArmState(is_stopped=True, reason="a button", stops=1))


def silence(_: Graph, node: PalletFsmNode, __: Any) -> None:
    node.on_peer("sim", is_alive=False)


@pytest.mark.parametrize(
    ("end", "reason"),
    [
        (cancel, "canceled on request"),
        (stop, "the arm was stopped: a button"),
        (silence, "node 'sim' is silent"),
    ],
)
def test_a_calibration_begins_with_a_move_tells_where_it_stands_and_ends_with_the_arm_at_rest(
    graph: Graph, end: Callable[[Graph, PalletFsmNode, Any], None], reason: str
) -> None:
    node, told = started(graph, "real"), list[Any]()
    handle = graph.send_goal(contracts.CALIBRATE, CalibrateCell.Goal(), told.append)
    targets = graph.probe.mail[motion_contracts.MOTION_TARGET.name]
    graph.wait_until(lambda: (targets and told) or tell(graph))
    assert targets[0].segments
    feedback = told[0].feedback
    assert (feedback.state, feedback.what) == ("touch surfaces", "picking table, from above")
    assert (feedback.number, feedback.count) == (1, 22)
    assert feedback.remaining > 100.0
    end(graph, node, handle)
    graph.wait_until(lambda: not targets[-1].segments or tell(graph))
    result = graph.result_of(handle)
    assert (result.success, result.message, result.calibration) == (False, reason, "")
    assert graph.probe.mail[contracts.PALLET_STATE.name] == []
