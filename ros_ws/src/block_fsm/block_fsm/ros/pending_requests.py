"""Requests of the executor, run by the nodes that can; each is looked at again and again until it is done."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace

from pack_interfaces.srv import JawCommand
from rclpy.client import Client
from rclpy.publisher import Publisher
from rclpy.task import Future
from std_srvs.srv import Trigger

from block_fsm.requests import Answer, MoveArm, MoveFingers, NoPicture, PlanFor
from block_fsm.ros.cell_state import CellState
from pack_core.blocks.gripper import FingerStatus
from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus
from pack_core.errors import PackError
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.ros.messages.blocks import from_response, to_request
from pack_core.ros.messages.motion import to_target

ENDED = (MotionState.REACHED, MotionState.STUCK, MotionState.REFUSED)


class PendingRequest(ABC):
    """One request under way; it began at `start` [s]."""

    def __init__(self, start: float) -> None:
        self._start = start

    @abstractmethod
    def poll(self, state: CellState) -> Answer | None:
        """The answer, once there is one; `state` is what is known now."""


class PendingLook(PendingRequest):
    """Waits until the arm is still, has a picture taken, and waits for what is seen in it."""

    def __init__(self, start: float, client: Client, delay: float, timeout: float) -> None:
        super().__init__(start)
        self._client, self._delay, self._timeout = client, delay, timeout
        self._trigger: Future | None = None
        self._trouble = "the camera does not answer"

    def poll(self, state: CellState) -> Answer | None:
        """The sighting, once it is of a picture taken late enough; asks again where the camera was busy."""
        if state.time < self._start + self._delay:
            return None
        sighting = state.sighting
        if sighting is not None and sighting.time >= self._start + self._delay:
            return sighting
        if state.time > self._start + self._delay + self._timeout:
            return NoPicture(f"no picture in {self._timeout:.0f} s: {self._trouble}")
        if self._trigger is None:
            self._trigger = self._client.call_async(Trigger.Request())
        elif self._trigger.done():
            self._note(self._trigger.result())
        return None

    def _note(self, response: Trigger.Response) -> None:
        self._trouble = response.message or "nothing is told of what is in it"
        if not response.success:
            self._trigger = None


class PendingPlan(PendingRequest):
    """Asks the planner, and waits for its answer."""

    def __init__(
        self, start: float, client: Client, request: PlanFor, method: str, seed: int, timeout: float
    ) -> None:
        super().__init__(start)
        self._timeout = timeout
        self._future = client.call_async(to_request(request.problem, method=method, seed=seed))

    def poll(self, state: CellState) -> Answer | None:
        """A planner that does not answer is one that ran out of time."""
        if self._future.done():
            try:
                return from_response(self._future.result())
            except PackError as error:
                reason = f"the planner's answer cannot be used: {error}"
                return Plan(PlanStatus.INVALID_INPUT, diagnosis=Diagnosis(reason))
        if state.time > self._start + self._timeout:
            return Plan(PlanStatus.TIMEOUT, diagnosis=Diagnosis("the planner does not answer"))
        return None


class PendingMove(PendingRequest):
    """Sends a target to the motion controller, and waits until it is reached or given up."""

    def __init__(
        self, start: float, publisher: Publisher, request: MoveArm, number: int, timeout: float
    ) -> None:
        super().__init__(start)
        self._number, self._timeout = number, timeout
        self._is_accepted = False
        publisher.publish(to_target(request.target(number), start))

    def poll(self, state: CellState) -> Answer | None:
        """A move is stuck that takes too long, or was interrupted and does not find on."""
        motion = state.motion
        if motion is None:
            return None
        if motion.id == self._number:
            if motion.state is MotionState.REFUSED and self._is_accepted:
                reason = f"interrupted, and no way on: {motion.reason}"
                return replace(motion, state=MotionState.STUCK, reason=reason)
            if motion.state in ENDED:
                return motion
            self._is_accepted = True
        late = state.time > self._start + self._timeout
        return _overdue(motion, self._timeout) if late else None


class PendingFingers(PendingRequest):
    """Sends a command to the gripper, and waits until the fingers are at rest."""

    def __init__(
        self,
        start: float,
        client: Client,
        request: MoveFingers,
        timeout: float,
        on_refusal: Callable[[str], None],
    ) -> None:
        super().__init__(start)
        self._timeout, self._on_refusal = timeout, on_refusal
        command = request.command
        self._future = client.call_async(JawCommand.Request(opening=command.opening, force=command.force))

    def poll(self, state: CellState) -> Answer | None:
        """Fingers that do not come to rest are answered as they are: moving."""
        if state.time > self._start + self._timeout:
            return state.fingers
        if not self._future.done() or state.fingers is None:
            return None
        response = self._future.result()
        if not response.success:
            self._on_refusal(f"the gripper refuses: {response.message}")
            return state.fingers
        is_heard = state.finger_commands >= response.command
        return state.fingers if is_heard and state.fingers.status is not FingerStatus.MOVING else None


def _overdue(motion: MotionStatus, timeout: float) -> MotionStatus:
    return replace(motion, state=MotionState.STUCK, reason=f"not there after {timeout:.0f} s")
