"""The planners of places as ROS 2 services: the layout of an order, and where a box of a shift goes."""

from __future__ import annotations

import time

from pack_interfaces.srv import PlanLayout, PlanPlace
from pydantic import Field

from pack_core.errors import OrderError, PackError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order_file import parse_order
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.palletizing import fill_answer, fill_layout, from_question
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pack_planner.layout.online_planner import OnlineConfig
from pack_planner.layout.place_answers import PlaceAnswers


class LayoutNodeConfig(LayoutConfig):
    """Parameters of the node `layout`."""

    online: OnlineConfig = OnlineConfig()
    preset: str = Field(default="rigid", description="of config/presets/palletizing")


class LayoutNode(CellNode):
    """Plans an order's layout on request, and in a cell for shifts where the next box goes."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__("layout", **kwargs)
        self._change(self.read_parameters(LayoutNodeConfig, self._change))
        self.offer(contracts.PLAN_LAYOUT, self._serve)
        if self._answers is not None:
            self.offer(contracts.PLAN_PLACE, self._answer)

    def _change(self, config: LayoutNodeConfig) -> None:
        """Plan with these parameters from the next request on."""
        self._cell = cell = palletizing_cell(config.preset)
        self._config, self._planner = config, LayoutPlanner(config)
        self._answers = None if cell.shift is None else PlaceAnswers(cell, config.online, config.insertion)
        self._asked = 0

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

    def _answer(self, request: PlanPlace.Request, response: PlanPlace.Response) -> PlanPlace.Response:
        assert self._answers is not None
        started = time.monotonic()
        self._asked += 1
        try:
            question = from_question(request, self._asked, self._cell.pallets)
            fill_answer(response, self._answers.answer(question))
        except PackError as error:
            response.message = str(error)
            self.health.count(f"refused {contracts.PLAN_PLACE.name}", _first_line(error))
            return response
        response.planning_time = time.monotonic() - started
        self.health.values["decision time [s]"] = f"{response.planning_time:.3f}"
        return response


def _first_line(error: PackError) -> str:
    lines = str(error).splitlines()
    more = f" (and {len(lines) - 1} more)" if isinstance(error, OrderError) and len(lines) > 1 else ""
    return lines[0] + more


def main() -> int:
    """Entry point of `layout_node`."""
    return run_node(LayoutNode)
