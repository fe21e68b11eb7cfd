"""Starts the errand that a request needs."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import MotionTarget
from pydantic import Field, NonNegativeFloat, PositiveFloat

from block_fsm.requests import Look, MoveArm, PlanFor, Request
from block_fsm.ros.cell_state import CellState
from block_fsm.ros.errands import Errand, JawErrand, LookErrand, MoveErrand, PlanErrand
from pack_core.config import Config
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion


class ErrandConfig(Config):
    """How long things may take, on the simulated clock."""

    exposure_delay: NonNegativeFloat = Field(
        default=0.1, description="before a picture, for the arm to be still [s]"
    )
    picture: PositiveFloat = Field(default=10.0, description="from exposure to the poses [s]")
    plan: PositiveFloat = Field(default=60.0, description="for the planner to answer [s]")
    move: PositiveFloat = Field(default=30.0, description="of the arm [s]")
    jaw: PositiveFloat = Field(default=3.0, description="of the fingers [s]")


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

    def begin(self, request: Request, method: str, seed: int, blocks: list[str]) -> Errand:
        """Have a request done.

        Args:
            request: of the executor.
            method: of the planner; empty: its own.
            seed: of the planner.
            blocks: ids of all blocks.
        """
        start, c = self._state.time, self._config
        if isinstance(request, Look):
            return LookErrand(start, self._trigger, c.exposure_delay, c.picture, blocks)
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
