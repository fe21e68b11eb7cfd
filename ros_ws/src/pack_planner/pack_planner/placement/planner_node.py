"""The placement planner and the planner of whole lists as ROS 2 services."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from pack_interfaces.msg import PlacementSample, SettledSamples
from pack_interfaces.msg import SettledSample as SettledSampleMessage
from pack_interfaces.srv import PlanFilling, PlanPlacement
from std_msgs.msg import String

from pack_core.errors import MessageError, PackError
from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import Arrangement, FillMethod
from pack_core.packing.packing_list import parse_list
from pack_core.packing.scene import Scene
from pack_core.packing.settled_sample import SettledSample
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import WORLD, finite, from_pose, to_pose, to_stamp
from pack_core.ros.messages.packing import checked_lean, fill_way
from pack_core.ros.messages.scene import from_scene
from pack_core.ros.node import CellNode
from pack_core.ros.packing import read_packing_cell
from pack_core.ros.run import run_node
from pack_core.rotations import Pose
from pack_planner.filling.arrangement_planner import ArrangementConfig
from pack_planner.filling.fill_planner import FillPlanner
from pack_planner.placement.placement_planner import PlacementPlannerConfig, PlacementPlanners
from pack_planner.placement.placement_result import SHOWN, PlacementSamples, PlannedPlacement
from pack_planner.placement.ros.placement_markers import to_visual_markers


class PlannerNode(CellNode):
    """Plans a placement on request, for the cell description that came last."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("planner", **kwargs)
        self._config = self.read_parameters(PlacementPlannerConfig, self._change)
        self._cell = read_packing_cell(self)
        self._scene: Scene | None = None
        self._planners: PlacementPlanners | None = None
        self._refusal = f"no description of the cell yet on {contracts.DESCRIPTION.name}: start the sim"
        self._markers = self.advertise(contracts.VISUAL_MARKERS)
        self._settled = self.advertise(contracts.SETTLED_SAMPLES)
        self.listen(contracts.DESCRIPTION, self._on_description)
        self.create_service(PlanPlacement, contracts.PLAN_PLACEMENT.name, self._serve)
        self.create_service(PlanFilling, contracts.PLAN_FILLING.name, self._serve_filling)
        self.watch(("sim", "perception"))

    def _change(self, config: PlacementPlannerConfig) -> None:
        """Plan with these parameters from the next request on."""
        if self._planners is not None and self._scene is not None:
            self._planners = PlacementPlanners(self._scene, self._cell, config)
        self._config = config

    @property
    def waits_for(self) -> str:
        return "" if self._planners is not None else self._refusal

    def _on_description(self, message: String) -> None:
        self._planners = None
        try:
            self._scene = Scene.from_yaml(message.data, contracts.DESCRIPTION.name)
            self._planners = PlacementPlanners(self._scene, self._cell, self._config)
        except PackError as error:
            self._refusal = str(error)
            raise

    def _serve(
        self, request: PlanPlacement.Request, response: PlanPlacement.Response
    ) -> PlanPlacement.Response:
        started = time.monotonic()
        try:
            placement = self._plan(request)
        except PackError as error:
            response.status, response.message = PlanPlacement.Response.INVALID_INPUT, str(error)
            self.health.count(f"refused {contracts.PLAN_PLACEMENT.name}", str(error))
            return response
        _fill(response, placement)
        response.planning_time = time.monotonic() - started
        self.health.values["planning time [s]"] = f"{response.planning_time:.3f}"
        return response

    def _serve_filling(
        self, request: PlanFilling.Request, response: PlanFilling.Response
    ) -> PlanFilling.Response:
        try:
            if self._scene is None:
                raise PackError(self._refusal)
            fill_response(response, plan_filling(request, self._scene, self._cell, self._config.arrangement))
        except PackError as error:
            response.message = str(error)
            self.health.count(f"refused {contracts.PLAN_FILLING.name}", str(error))
        return response

    def _plan(self, request: PlanPlacement.Request) -> PlannedPlacement:
        if self._planners is None or self._scene is None:
            raise PackError(self._refusal)
        state = from_scene(request.scene)
        placement = self._planners.of(request.variant).plan(
            state,
            np.random.default_rng(request.seed),
            lean=checked_lean(request.lean),
            avoid=[finite([p.x, p.y, p.z], "point to avoid") for p in request.avoid],
            avoid_radius=_checked_radius(request.avoid_radius),
            near=from_pose(request.near[0]) if request.near else None,
        )
        shown = placement.samples.spread(SHOWN)
        self._markers.publish(to_visual_markers(state.time, placement, self._scene, shown[0]))
        self._settled.publish(to_settled_samples(state.time, shown))
        return placement


def _checked_radius(radius: float) -> float:
    if not 0.0 <= radius < np.inf:
        raise MessageError(f"avoid_radius is {radius}; allowed: metres from 0 on")
    return radius


def _fill(response: PlanPlacement.Response, placement: PlannedPlacement) -> None:
    response.status, response.message = int(placement.status), placement.reason
    response.collisions, response.cost = list(placement.collisions), placement.cost
    fill_way(response, placement.way)
    response.is_rehearsed = placement.is_rehearsed
    response.samples = _to_samples(placement.samples)
    if placement.X_WO is not None:
        response.pose = to_pose(placement.X_WO)


def _to_samples(samples: PlacementSamples) -> list[PlacementSample]:
    rows = zip(samples.sampled, samples.settled, samples.costs, samples.is_feasible, strict=True)
    return [
        PlacementSample(
            pose=to_pose(Pose(sampled[:3], sampled[3:])), settled=to_pose(Pose(settled[:3], settled[3:])),
            cost=float(cost), is_feasible=bool(is_feasible),
        )
        for sampled, settled, cost, is_feasible in rows
    ]  # fmt: skip


def to_settled_samples(time: float, samples: Sequence[SettledSample]) -> SettledSamples:
    """The message for samples of a placement that was planned for the scene at `time` [s]."""
    message = SettledSamples(samples=[_to_message(sample) for sample in samples])
    message.header.stamp, message.header.frame_id = to_stamp(time), WORLD
    return message


def _to_message(sample: SettledSample) -> SettledSampleMessage:
    return SettledSampleMessage(
        cost=sample.cost, rank=sample.rank, is_feasible=sample.is_feasible, names=list(sample.poses),
        poses=[to_pose(X_WO) for X_WO in sample.poses.values()],
    )  # fmt: skip


def plan_filling(
    request: PlanFilling.Request, scene: Scene, cell: PackingCell, config: ArrangementConfig
) -> Arrangement:
    """Arrange the objects of a request.

    Raises:
        PackError: the list, the method or a pose cannot be used.
    """
    given = parse_list(request.list, "request", cell)
    if len(request.planned) != len(request.planned_poses):
        raise MessageError(
            f"{len(request.planned)} names in `planned`, {len(request.planned_poses)} poses; allowed: as many"
        )
    poses = map(from_pose, request.planned_poses)
    planned = dict(zip(request.planned, poses, strict=True))
    planner = FillPlanner(config, FillMethod.of(request.method), given.order)
    rng = np.random.default_rng(request.seed)
    return planner.plan(scene, from_scene(request.scene), given.objects, rng, planned)


def fill_response(response: PlanFilling.Response, found: Arrangement) -> None:
    """Write an arrangement into the response."""
    response.success, response.order = True, list(found.order)
    response.placed = list(found.poses)
    response.poses = [to_pose(X_WO) for X_WO in found.poses.values()]
    response.refused, response.reasons = list(found.refused), list(found.refused.values())


def main() -> int:
    """Entry point of `planner_node`."""
    return run_node(PlannerNode)
