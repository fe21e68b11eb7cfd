"""The service /plan_filling: from its request to an arrangement, and from that to the response."""

from __future__ import annotations

import numpy as np
from pack_interfaces.srv import PlanFilling

from pack_core.errors import MessageError
from pack_core.packing.arrangement import Arrangement, FillMethod
from pack_core.packing.cell import PackingCell
from pack_core.packing.packing_list import parse_list
from pack_core.packing.scene import Scene
from pack_core.ros.messages.conversions import from_pose, to_pose
from pack_core.ros.messages.scene import from_scene
from pack_planner.filling.arrangement_config import ArrangementConfig
from pack_planner.filling.fill_planner import FillPlanner


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
