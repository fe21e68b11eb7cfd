"""The rearrangement planner as a ROS 2 service."""

from __future__ import annotations

import time

from pack_interfaces.srv import PlanRearrangement

from pack_core.blocks.plan import Plan
from pack_core.errors import PackError
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.messages.blocks import fill_plan, from_request
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_planner.rearrangement.methods import PlanningConfig
from pack_planner.rearrangement.planning import plan, warm_up


class RearrangementNode(CellNode):
    """Plans rearrangements on request."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__("rearrangement", **kwargs)
        self._config = self.read_parameters(PlanningConfig, self._change)
        warm_up()
        self.offer(contracts.PLAN_REARRANGEMENT, self._serve)

    def _change(self, config: PlanningConfig) -> None:
        """Plan with these parameters from the next request on."""
        self._config = config

    def _serve(
        self, request: PlanRearrangement.Request, response: PlanRearrangement.Response
    ) -> PlanRearrangement.Response:
        try:
            made = self._plan(request)
        except PackError as error:
            response.status, response.message = PlanRearrangement.Response.INVALID_INPUT, str(error)
            self.health.count(f"refused {contracts.PLAN_REARRANGEMENT.name}", str(error))
            return response
        fill_plan(response, made)
        self.health.values["last plan"] = f"{made.status.name}, {len(made.actions)} actions"
        self.health.values["planning time [s]"] = f"{made.statistics.total_s:.3f}"
        return response

    def _plan(self, request: PlanRearrangement.Request) -> Plan:
        return plan(
            from_request(request),
            method=request.method or self._config.method,
            budget_s=request.budget or self._config.budget,
            seed=request.seed,
            config=self._config,
            clock=time.perf_counter,
        )


def main() -> int:
    """Entry point of `rearrangement_node`."""
    return run_node(RearrangementNode)
