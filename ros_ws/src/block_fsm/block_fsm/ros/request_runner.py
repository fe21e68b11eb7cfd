"""Carries out the executor's requests in the running cell: each by the steps that lead to its answer."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import JawState, MotionTarget
from pack_interfaces.srv import JawCommand
from std_srvs.srv import Trigger

from block_fsm.executor_config import RequestTimeouts
from block_fsm.requests import Answer, ExecutorRequest, Look, MoveArm, MoveFingers, NoPicture, PlanFor
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.gripper import FingerState, FingerStatus
from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus
from pack_core.errors import PackError
from pack_core.motion.target import MotionStatus
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.messages.blocks import from_finger_state, from_response, from_sighting, to_request
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import to_target
from pack_core.ros.messages.serialized_status import MotionStatusReader
from pack_core.ros.newest_messages import Kept, NewestMessages
from pack_core.ros.node import CellNode
from pack_core.tasks.move import MoveFollower, follow
from pack_core.tasks.steps import Steps, wait


class RequestRunner:
    """Sends each request to the node that can do it, and waits for the answer in its steps.

    Args:
        node: that asks.
        config: how long things may take.
        on_motion: is called in a thread of its own with every status of the motion.
        on_refusal: is told why a node refused.
    """

    def __init__(
        self, node: CellNode, config: RequestTimeouts, on_motion: Callable[[], None],
        on_refusal: Callable[[str], None],
    ) -> None:  # fmt: skip
        self._node, self._config, self._on_refusal = node, config, on_refusal
        self._target = node.advertise(motion.MOTION_TARGET)
        self._trigger, self._planner, self._jaw = (
            node.create_client(contract.type, contract.name)
            for contract in (contracts.TRIGGER, contracts.PLAN_REARRANGEMENT, contracts.JAW_COMMAND)
        )
        self._follower = MoveFollower(config.move, config.move)
        self._finger_commands = 0
        self._heard = NewestMessages(
            node,
            (
                Kept(contracts.BLOCK_POSES, from_sighting),
                Kept(contracts.JAW_STATE, self._to_fingers),
                Kept(motion.MOTION_STATUS, MotionStatusReader().read, depth=1, raw=True),
            ),
        )
        self._heard.follow(on_motion)

    def end(self) -> None:
        """Listen no more."""
        self._heard.end()

    @property
    def time(self) -> float:
        """On the clock [s]; the status of the motion is ahead of it, as setpoints are, and tells no time."""
        return from_stamp(self._node.get_clock().now().to_msg())

    @property
    def motion(self) -> MotionStatus | None:
        """The newest status of the motion."""
        status: MotionStatus | None = self._heard[motion.MOTION_STATUS]
        return status

    @property
    def fingers(self) -> FingerState | None:
        """The newest state of the fingers."""
        fingers: FingerState | None = self._heard[contracts.JAW_STATE]
        return fingers

    @property
    def sighting(self) -> BlockSighting | None:
        """The newest, of this run of the simulator."""
        sighting: BlockSighting | None = self._heard.until(contracts.BLOCK_POSES, self.time)
        return sighting

    def steps(self, request: ExecutorRequest, method: str, seed: int) -> Steps[Answer]:
        """What leads to the answer of a request.

        Args:
            request: of the executor.
            method: of the planner; empty: its own.
            seed: of the planner.
        """
        match request:
            case Look():
                return self._look()
            case PlanFor():
                return self._plan(request, method, seed)
            case MoveArm():
                return self._move(request)
            case MoveFingers():
                return self._move_fingers(request)

    def stop(self) -> None:
        """Have the arm brake: a target without segments."""
        self._target.publish(MotionTarget(id=self._follower.number))

    def _look(self) -> Steps[Answer]:
        """Wait until the arm is still, have a picture taken, and wait for what is seen in it.

        It is asked for again where the camera was busy.
        """
        begun, longest = self.time, self._config.picture
        exposure = begun + self._config.exposure_delay
        yield from wait(lambda: not begun <= self.time < exposure, float("inf"), self._clock)
        if self.time < begun:
            return NoPicture("time has begun anew")
        trigger, trouble = None, "the camera does not answer"
        while (sighting := self.sighting) is None or sighting.time < exposure:
            if self.time > exposure + longest:
                return NoPicture(f"no picture in {longest:.0f} s: {trouble}")
            if trigger is None:
                trigger = self._trigger.call_async(Trigger.Request())
            elif trigger.done():
                response = trigger.result()
                trouble = response.message or "nothing is told of what is in it"
                trigger = trigger if response.success else None
            yield
        return sighting

    def _plan(self, request: PlanFor, method: str, seed: int) -> Steps[Answer]:
        """A planner that does not answer is one that ran out of time."""
        pending = self._planner.call_async(to_request(request.problem, method=method, seed=seed))
        if not (yield from wait(pending.done, self._config.plan, self._clock)):
            return Plan(PlanStatus.TIMEOUT, diagnosis=Diagnosis("the planner does not answer"))
        try:
            return from_response(pending.result())
        except PackError as error:
            reason = f"the planner's answer cannot be used: {error}"
            return Plan(PlanStatus.INVALID_INPUT, diagnosis=Diagnosis(reason))

    def _move(self, request: MoveArm) -> Steps[Answer]:
        """A move is stuck that takes too long, or was interrupted and does not find on."""
        number = self._follower.begin(self.motion, self.time)
        self._target.publish(to_target(request.target(number), self.time))
        return (yield from follow(self._follower, lambda: self.motion, self._clock))

    def _move_fingers(self, request: MoveFingers) -> Steps[Answer]:
        """Fingers that do not come to rest are answered as they are: moving."""
        command = request.command
        pending = self._jaw.call_async(JawCommand.Request(opening=command.opening, force=command.force))

        def is_done() -> bool:
            if not pending.done() or self.fingers is None:
                return False
            is_heard = self._finger_commands >= pending.result().command
            is_at_rest = is_heard and self.fingers.status is not FingerStatus.MOVING
            return is_at_rest or not pending.result().success

        yield from wait(is_done, self._config.jaw, self._clock)
        if pending.done() and not pending.result().success:
            self._on_refusal(f"the gripper refuses: {pending.result().message}")
        assert self.fingers is not None, "no goal is taken before the gripper was heard"
        return self.fingers

    def _clock(self) -> float:
        return self.time

    def _to_fingers(self, message: JawState) -> FingerState:
        fingers = from_finger_state(message)
        self._finger_commands = message.command
        return fingers
