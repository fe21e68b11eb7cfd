"""Which object of a list comes next and where it shall stand: one plan for each method of filling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from pack_core.errors import PackError
from pack_core.packing.free_space import fitting_yaws, is_packed
from pack_core.packing.goals import Arrangement, FillMethod
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingOrder
from pack_core.packing.scene import Container, Scene
from pack_core.rotations import Pose
from pack_core.states import SceneState
from pack_planner.filling.arrangement_planner import NO_ROOM, ArrangementConfig, ArrangementPlanner


class FillPlanner:
    """Plans the next object of a list.

    Args:
        config: parameters.
        method: how places are chosen.
        order: whether the list's order binds.
    """

    def __init__(self, config: ArrangementConfig, method: FillMethod, order: PackingOrder) -> None:
        self._method, self._order = method, order
        is_close = method is FillMethod.CONTACT
        gap, wall_gap = (config.gap, config.wall_gap) if is_close else (config.free_gap,) * 2
        self._arrangements = ArrangementPlanner(config, gap, wall_gap)

    def plan(
        self, scene: Scene, state: SceneState, items: Sequence[ObjectModel], rng: np.random.Generator,
        planned: Mapping[str, Pose] = MappingProxyType({}),
    ) -> Arrangement:  # fmt: skip
        """Arrange the objects that are still to come.

        Args:
            scene: the container and what has been packed; the new object counts if it is in the container.
            state: where these objects are.
            items: the remaining objects, in the list's order.
            rng: source of the variations.
            planned: where the last arrangement had them, X_WO.
        """
        misfits = _misfits(scene.container, items)
        items = [item for item in items if item.name not in misfits]
        names = tuple(item.name for item in items)
        if self._method is FillMethod.RANDOM:
            return Arrangement(names, refused=misfits)
        poses = state.poses()
        known = [item for item in (*scene.objects, scene.new_object) if item.name in poses]
        inside = [item for item in known if is_packed(scene, poses[item.name])]
        standing = [(item, poses[item.name]) for item in inside if item.name not in names]
        placed = self._arrangements.plan(scene.container, standing, items, rng, planned)
        by_height = sorted(placed, key=lambda name: float(placed[name].p[2]))
        others = [name for name in names if name not in placed]
        order = list(names) if self._order is PackingOrder.LIST else [*by_height, *others]
        there = [item for item, _ in standing]
        refused = others if self._method is FillMethod.NO_CONTACT else []
        order = [name for name in order if name not in refused]
        by_name = {item.name: item for item in items}
        # with contact, what stands there may be pushed aside for the next one
        while order and order[0] not in placed:
            if self._arrangements.could_fit(scene.container, [*there, by_name[order[0]]], rng):
                break
            refused.append(order.pop(0))
        return Arrangement(tuple(order), placed, misfits | dict.fromkeys(refused, NO_ROOM))


def _misfits(container: Container, items: Sequence[ObjectModel]) -> dict[str, str]:
    """Objects that do not fit into the container even when it is empty, with the reason."""
    found = {}
    for item in items:
        try:
            fitting_yaws(item, container, 0.0)
        except PackError as error:
            found[item.name] = str(error)
    return found
