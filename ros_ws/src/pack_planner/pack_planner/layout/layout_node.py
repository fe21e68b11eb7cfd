"""The layout planner as a ROS 2 service."""

from __future__ import annotations

import time

from pack_interfaces.srv import PlanLayout

from pack_core.errors import OrderError, PackError
from pack_core.palletizing.orders.order_file import parse_order
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.palletizing import fill_layout
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner


class LayoutNode(CellNode):
    """Plans an order's layout on request."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__("layout", **kwargs)
        self._change(self.read_parameters(LayoutConfig, self._change))
        self.offer(contracts.PLAN_LAYOUT, self._serve)

    def _change(self, config: LayoutConfig) -> None:
        """Plan with these parameters from the next request on."""
        self._config, self._planner = config, LayoutPlanner(config)

    def _serve(self, request: PlanLayout.Request, response: PlanLayout.Response) -> PlanLayout.Response:
        started = time.monotonic()
        try:
            order = parse_order(request.order, "the order of the request", self._config.support)
            plan = self._planner.plan(order, request.gap if request.gap >= 0.0 else None)
        except PackError as error:
            response.status, response.message = PlanLayout.Response.INVALID_INPUT, str(error)
            self.health.count(f"refused {contracts.PLAN_LAYOUT.name}", _first_line(error))
            return response
        fill_layout(response, plan)
        response.planning_time = time.monotonic() - started
        self.health.values["planning time [s]"] = f"{response.planning_time:.3f}"
        return response


def _first_line(error: PackError) -> str:
    lines = str(error).splitlines()
    more = f" (and {len(lines) - 1} more)" if isinstance(error, OrderError) and len(lines) > 1 else ""
    return lines[0] + more


def main() -> int:
    """Entry point of `layout_node`."""
    return run_node(LayoutNode)
