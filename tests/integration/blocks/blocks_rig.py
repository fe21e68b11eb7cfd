"""Plays arm, gripper, camera and planner for the executor of the blocks cell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from pack_interfaces.msg import BlockSighting as BlockSightingMsg
from pack_interfaces.msg import MotionTarget as MotionTargetMsg
from pack_interfaces.srv import JawCommand, PlanRearrangement
from rclpy.clock import Clock, ClockType
from std_srvs.srv import Trigger

from integration.harness import Graph
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.gripper import FingerState, FingerStatus
from pack_core.blocks.plan import Plan, PlanStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.messages.blocks import fill_plan, to_finger_state, to_sighting
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import to_status
from pack_core.rotations import Pose

PERIOD = 0.01
AHEAD = 0.040
"""By which the status of the motion is ahead of the clock [s]."""


@dataclass
class BlocksRig:
    """A cell whose moves are done at once; tests change what it says.

    Attributes:
        graph: with the node under test.
        poses: of the blocks that the camera sees.
        camera: what the camera answers to a request for a picture; empty: that it takes one.
        on_sighting: may change what is told of a picture.
        plan: the planner's answer.
        on_plan: may change it as a message.
        state: of the motion, after each target.
        reason: of the motion.
        refused: label of a segment; the first target that begins with it is refused.
        problems: that plans were asked for.
    """

    graph: Graph
    poses: dict[str, PlanarPose]
    camera: str = ""
    on_sighting: Callable[[BlockSightingMsg], None] = lambda message: None
    plan: Plan = field(default_factory=lambda: Plan(PlanStatus.OPTIMAL))
    on_plan: Callable[[PlanRearrangement.Response], None] = lambda response: None
    state: MotionState = MotionState.REACHED
    reason: str = ""
    refused: str = ""
    problems: list[PlanRearrangement.Request] = field(default_factory=list)
    targets: list[MotionTargetMsg] = field(default_factory=list)
    fingers: FingerState = field(default_factory=lambda: FingerState(0.0, 0.06, 0.0, FingerStatus.AT_OPENING))
    commands: int = 0

    def __post_init__(self) -> None:
        probe = self.graph.probe
        for contract, serve in (
            (contracts.TRIGGER, self._expose),
            (contracts.JAW_COMMAND, self._move_fingers),
            (contracts.PLAN_REARRANGEMENT, self._make_plan),
        ):
            probe.create_service(contract.type, contract.name, serve)
        target = motion.MOTION_TARGET
        probe.create_subscription(target.type, target.name, self.targets.append, target.qos)
        probe.create_timer(PERIOD, self._say, clock=Clock(clock_type=ClockType.STEADY_TIME))

    @property
    def time(self) -> float:
        return from_stamp(self.graph.probe.get_clock().now().to_msg())

    def _say(self) -> None:
        number, state = self.targets[-1].id if self.targets else 0, self.state
        meant = [t.id for t in self.targets if t.segments and t.segments[0].label == self.refused]
        if meant and number == meant[0]:
            state = MotionState.REFUSED
        X_WT = Pose([0.4, -0.3, 0.4], [0.0, 1.0, 0.0, 0.0])
        status = MotionStatus(
            self.time + AHEAD, number, state, 0, "", 0.0, 0.0, 0.0, 0.0, 3, self.reason, X_WT
        )
        self.graph.probe.send(motion.MOTION_STATUS, to_status(status))
        self.graph.probe.send(contracts.JAW_STATE, to_finger_state(self.fingers, self.commands))

    def _expose(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success, response.message = not self.camera, self.camera
        if response.success:
            message = to_sighting(BlockSighting(self.time, self.poses))
            self.on_sighting(message)
            self.graph.probe.send(contracts.BLOCK_POSES, message)
        return response

    def _move_fingers(
        self, request: JawCommand.Request, response: JawCommand.Response
    ) -> JawCommand.Response:
        self.commands += 1
        self.fingers = FingerState(self.time, request.opening, request.force, FingerStatus.AT_OPENING)
        response.success, response.command = True, self.commands
        return response

    def _make_plan(
        self, request: PlanRearrangement.Request, response: PlanRearrangement.Response
    ) -> PlanRearrangement.Response:
        self.problems.append(request)
        fill_plan(response, self.plan)
        self.on_plan(response)
        return response
