"""The palletizing machine as a ROS 2 node: orders and calibrations in, motion targets and grips out."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from pack_interfaces.action import CalibrateCell, Palletize, RunShift
from pack_interfaces.srv import PlanLayout
from pydantic import Field
from std_msgs.msg import String

from pack_core.errors import ConfigError
from pack_core.palletizing.calibration import known_cell
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.orders.box_stream import listed_items, shipped_lists
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.ports import StopArm
from pack_core.palletizing.shift_journal import JOURNAL, ShiftJournal
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.markers import goal_markers, vertex_markers
from pack_core.ros.messages.palletizing import from_layout
from pack_core.ros.run import run_node
from pallet_calibration.ros.calibration_action import CalibrationAction
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer import Palletizer, warm_up
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.ros.cell_ports import CellPorts
from pallet_fsm.ros.order_goal import (
    OrderRun,
    StatePublisher,
    places,
    requested_config,
    requested_order,
    to_result,
)
from pallet_fsm.ros.shift_goal import ShiftGoalRun, TakeOverLook, requested_shift
from pallet_fsm.shift_job import ShiftConfig, ShiftJob
from pallet_fsm.states import profile_of
from pallet_fsm.taking_over import TakenOver, standing_by_journal


class PalletFsmNodeConfig(PalletizerConfig):
    """Parameters of the node `fsm`."""

    watched: tuple[str, ...] = Field(
        default=("sim", "vision", "layout", "motion", "recorder"),
        description="the order stops safely when one of them stays silent",
    )
    fault_time: float = Field(default=2.0, gt=0, description="silence that ends an order [s of wall clock]")
    preset: str = Field(default="rigid", description="of config/presets/palletizing")
    calibration: str = Field(default="", description="calibration file of the cell; empty: none")
    shift: ShiftConfig = ShiftConfig()


class PalletFsmNode(GoalNode):
    """Builds one order at a time, runs a shift, or calibrates the cell."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("fsm", **kwargs)
        self._change(self.read_parameters(PalletFsmNodeConfig, self._change))
        warm_up()
        self._run: OrderRun | ShiftGoalRun | None = None
        self._stepping = threading.Lock()
        cell = palletizing_cell(self._config.preset)
        self._has_shifts = cell.shift is not None
        self._cell = CellPorts(self, self._step, self._on_failure, cell)
        self._calibration = CalibrationAction(self, self._cell.observe, self._cell.apply)
        self._states = StatePublisher(self)
        self._result = self.advertise(contracts.RESULT)
        self._goals = self.advertise(motion.GOAL_MARKERS)
        self._layout = self.create_client(contracts.PLAN_LAYOUT.type, contracts.PLAN_LAYOUT.name)
        self.take_goals(
            contracts.PALLETIZE, self._config.watched, self._config.fault_time, contracts.CALIBRATE,
            contracts.RUN_SHIFT,
        )  # fmt: skip

    def _change(self, config: PalletFsmNodeConfig) -> None:
        """Use these parameters from the next order on."""
        profile_of(config.profile)
        self._config = config

    def destroy_node(self) -> None:
        """Step no more, then end."""
        self._cell.end()
        super().destroy_node()

    @property
    def waits_for(self) -> str:
        if not self._cell.is_heard:
            return "nothing heard of arm and gripper yet: are sim and motion up?"
        if not self._layout.service_is_ready():
            return f"no service {contracts.PLAN_LAYOUT.name}: is layout up?"
        if self._has_shifts and not self._cell.plan_place.service_is_ready():
            return f"no service {contracts.PLAN_PLACE.name}: does layout have the same preset?"
        return ""

    def refusal(self, request: Palletize.Goal | CalibrateCell.Goal | RunShift.Goal) -> str:
        if isinstance(request, RunShift.Goal) and not self._has_shifts:
            return (
                f"the cell has no conveyor under the preset '{self._config.preset}'; "
                "`pack up palletizing --preset shift` has one"
            )
        if isinstance(request, RunShift.Goal) and not profile_of(self._config.profile).is_blended:
            return (
                f"the profile '{self._config.profile}' rests over the pallet, where none can be replaced; "
                "allowed for shifts: fsm.profile=blended"
            )
        grip = self._cell.grip
        if grip is not None and grip.is_closed:
            return (
                f"the gripper holds '{grip.held}', as after a stop in the middle of an order; "
                f"support it and call {contracts.GRIPPER_COMMAND.name} with close=false, or reset the cell"
            )
        return self.waits_for

    async def pursue(
        self, request: Palletize.Goal | CalibrateCell.Goal | RunShift.Goal
    ) -> Palletize.Result | CalibrateCell.Result | RunShift.Result:
        """Build an order, run a shift, or calibrate; nothing moves before what is asked was checked."""
        known = known_cell(self._config.preset, self._config.calibration)
        if isinstance(request, RunShift.Goal):
            return await self._run_shift(request, known.cell)
        if isinstance(request, CalibrateCell.Goal):
            return await self._calibration.pursue(request, known)
        try:
            order = requested_order(request, known.cell)
            config = requested_config(request, self._config)
            plan = await self._plan(order)
            known.check_gap(plan.gap)
            return await self._build(order, plan, known.cell, config)
        finally:
            with self._stepping:
                self._run = None

    async def _run_shift(self, request: RunShift.Goal, cell: PalletizingCell) -> RunShift.Result:
        before = requested_shift(request, self._config.preset)
        catalogue = {item.id: item for item in listed_items(shipped_lists())}

        def begin(found: TakenOver, boxes: int) -> ShiftJob:
            return ShiftJob(cell, catalogue, self._config.shift, self._config, boxes, found)

        self._cell.begin_shift()
        self._goals.publish(goal_markers({}))  # of the last order
        with ShiftJournal(Path(request.folder) / JOURNAL, before.facts) as journal:
            standing, clearances = standing_by_journal(before.events), self._config.shift.clearances(cell)
            look = TakeOverLook(cell, standing, self._config, clearances)
            self._run = run = ShiftGoalRun(
                self, cell, before, journal, begin, self._cell.apply, self._states, look
            )
            try:
                await self.until_goal_ends()
            finally:
                with self._stepping:  # no step may write to a journal that is closed
                    self._run = None
        return run.result()

    def describe(self, result: Palletize.Result | CalibrateCell.Result | RunShift.Result) -> str:
        if isinstance(result, CalibrateCell.Result):
            return result.message or f"{result.execution_time:.0f} s, as expected"
        return "; ".join(filter(None, (f"{result.placed} of {result.boxes} boxes", result.message)))

    async def _plan(self, order: Order) -> LayoutPlan:
        request = PlanLayout.Request(order=order.model_dump_json(exclude_none=True), gap=-1.0)
        response = await self.answers.of(self._layout, request)
        if response.status != LayoutStatus.SUCCESS:
            raise ConfigError(f"order {order.order_id}: {response.message}")
        return from_layout(response)

    async def _build(
        self, order: Order, plan: LayoutPlan, cell: PalletizingCell, config: PalletizerConfig
    ) -> Palletize.Result:
        seen = self._cell.observe()
        assert seen is not None
        goals = places(plan, cell)
        shown = goal_markers(goals)
        shown.markers = [*shown.markers, *vertex_markers(goals).markers]
        self._goals.publish(shown)
        session = Palletizer(OrderBook.of_order(order, plan, cell), cell, config, seen.time)
        self._run = run = OrderRun(self, session, self._cell.apply, self._states)
        await self.until_goal_ends()
        result = to_result(session.report(), run.elapsed)
        self._result.publish(String(data=result.report))
        return result

    def _step(self) -> None:
        """Step the machine once; called in a thread of its own after every status of the motion."""
        with self._stepping:
            if self._run is not None and (seen := self._cell.observe()) is not None:
                self._run.step(seen)

    def _on_failure(self, reason: str) -> None:
        self.health.count("failed command", reason)
        self.get_logger().error(reason)
        self._calibration.halt(reason)
        if self._run is not None:
            self._run.halt(reason)

    def on_lost_peers(self, peers: list[str]) -> None:
        """Halt the machine; the silent node may be the one whose messages would keep it going."""
        self._halt(f"node '{peers[0]}' is silent")

    def on_arm_stop(self, reason: str) -> None:
        self._halt(reason)

    def give_up(self) -> None:
        with self._stepping:  # no step may send a target after the stop
            self._run = None
        self._calibration.forget()
        self._cell.apply(StopArm())

    def _halt(self, reason: str) -> None:
        self._calibration.halt(reason)
        if self._run is not None:
            self._run.halt(reason)
            self._step()
        self.answers.give_up(reason)


def main() -> int:
    """Entry point of `fsm_node`."""
    return run_node(PalletFsmNode)
