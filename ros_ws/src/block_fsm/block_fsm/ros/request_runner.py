"""Starts the requests of the executor, each with the node that can carry it out."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import MotionTarget

from block_fsm.executor_config import RequestTimeouts
from block_fsm.requests import ExecutorRequest, Look, MoveArm, PlanFor
from block_fsm.ros.cell_state import CellState
from block_fsm.ros.pending_requests import (
    PendingFingers,
    PendingLook,
    PendingMove,
    PendingPlan,
    PendingRequest,
)
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.node import CellNode


class RequestRunner:
    """Sends each request to the node that can do it.

    Args:
        node: that asks.
        state: what is known of the cell.
        config: patience.
        on_refusal: is told why a node refused.
    """

    def __init__(
        self, node: CellNode, state: CellState, config: RequestTimeouts, on_refusal: Callable[[str], None]
    ) -> None:
        self._state, self._config, self._on_refusal = state, config, on_refusal
        self._target = node.advertise(motion.MOTION_TARGET)
        self._trigger, self._planner, self._fingers = (
            node.create_client(contract.type, contract.name)
            for contract in (contracts.TRIGGER, contracts.PLAN_REARRANGEMENT, contracts.JAW_COMMAND)
        )
        self._number = 0

    def begin(self, request: ExecutorRequest, method: str, seed: int) -> PendingRequest:
        """Send a request, and return what tells when it is done.

        Args:
            request: of the executor.
            method: of the planner; empty: its own.
            seed: of the planner.
        """
        start, c = self._state.time, self._config
        if isinstance(request, Look):
            return PendingLook(start, self._trigger, c.exposure_delay, c.picture)
        if isinstance(request, PlanFor):
            return PendingPlan(start, self._planner, request, method, seed, c.plan)
        if isinstance(request, MoveArm):
            status = self._state.motion
            self._number = max(self._number, status.id if status is not None else 0) + 1
            return PendingMove(start, self._target, request, self._number, c.move)
        return PendingFingers(start, self._fingers, request, c.jaw, self._on_refusal)

    def stop(self) -> None:
        """Have the arm brake: a target without segments."""
        self._target.publish(MotionTarget(id=self._number))
