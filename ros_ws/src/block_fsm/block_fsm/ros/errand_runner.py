"""Starts the errand that a request needs."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import MotionTarget

from block_fsm.executor_config import ErrandConfig
from block_fsm.requests import Look, MoveArm, PlanFor, Request
from block_fsm.ros.cell_state import CellState
from block_fsm.ros.errands import Errand, JawErrand, LookErrand, MoveErrand, PlanErrand
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion


class ErrandRunner:
    """Knows which node does what.

    Args:
        node: that asks.
        state: what is known of the cell.
        config: patience.
        on_refusal: is told why a node refused.
    """

    def __init__(
        self, node: CellNode, state: CellState, config: ErrandConfig, on_refusal: Callable[[str], None]
    ) -> None:
        self._state, self._config, self._on_refusal = state, config, on_refusal
        self._target = node.advertise(motion.MOTION_TARGET)
        self._trigger, self._planner, self._jaw = (
            node.create_client(contract.type, contract.name)
            for contract in (contracts.TRIGGER, contracts.PLAN_REARRANGEMENT, contracts.JAW_COMMAND)
        )
        self._number = 0

    def begin(self, request: Request, method: str, seed: int) -> Errand:
        """Have a request done.

        Args:
            request: of the executor.
            method: of the planner; empty: its own.
            seed: of the planner.
        """
        start, c = self._state.time, self._config
        if isinstance(request, Look):
            return LookErrand(start, self._trigger, c.exposure_delay, c.picture)
        if isinstance(request, PlanFor):
            return PlanErrand(start, self._planner, request, method, seed, c.plan)
        if isinstance(request, MoveArm):
            status = self._state.motion
            self._number = max(self._number, status.id if status is not None else 0) + 1
            return MoveErrand(start, self._target, request, self._number, c.move)
        return JawErrand(start, self._jaw, request, c.jaw, self._on_refusal)

    def stop(self) -> None:
        """Have the arm brake: a target without segments."""
        self._target.publish(MotionTarget(id=self._number))
