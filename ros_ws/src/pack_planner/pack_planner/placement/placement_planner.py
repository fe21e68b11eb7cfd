"""The placement planners: their interface, their register, and those of one scene.

The node, lockstep, replay and, through presets, the command line create their planners here. A further
planner is a class with the interface of `PlacementPlanner`; it is known by one line in `PLACEMENT_PLANNERS`
or, in another package, by an entry point.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Protocol

import numpy as np
import numpy.typing as npt
from pydantic import AfterValidator, Field

from pack_core.config import NEXT_REQUEST
from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.register import Register
from pack_core.rotations import Pose
from pack_core.states import SceneState
from pack_planner.filling.arrangement_planner import ArrangementConfig
from pack_planner.placement.placement_evaluation import PlacementConfig
from pack_planner.placement.placement_result import PlannedPlacement


class PlacementPlanner(Protocol):
    """Plans placements of one scene's new object."""

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02, near: Pose | None = None,
    ) -> PlannedPlacement:  # fmt: skip
        """Choose a placement.

        Args:
            state: where the objects are, the new one included; taken to be at rest.
            rng: source of the samples.
            lean: how far the object will be tilted at its entry [rad].
            avoid: positions `(3,)` [m] of placements that were tried before. A sample within `avoid_radius`
                of one, as seen from above, is chosen only if all samples are, and then the farthest.
            avoid_radius: horizontal distance to keep from them [m].
            near: pose X_WN about which the first placement is sought; None: anywhere.

        Raises:
            PackError: `state` lacks an object, or has one that the scene does not know.
        """
        ...


MakePlanner = Callable[[Scene, PackingCell, PlacementConfig], PlacementPlanner]
"""Builds a planner for a scene, whose poses are ignored; raises PackError if the object cannot fit."""

PLACEMENT_PLANNERS: Register[MakePlanner] = Register(
    "placement planner",
    "pack_planner.placement_planners",
    {
        "physics": "pack_planner.placement.least_disturbance_planner:LeastDisturbancePlanner",
        "algorithm_1": "pack_planner.placement.least_disturbance_planner:Algorithm1Planner",
    },
)
"""All placement planners, by their value of the parameter `variant`."""


class PlacementPlannerConfig(PlacementConfig):
    """Which planner plans, and the parameters that all of them share."""

    variant: Annotated[str, NEXT_REQUEST, AfterValidator(PLACEMENT_PLANNERS.known)] = Field(
        "physics",
        description="physics: Algorithm 1 with rehearsed entries; algorithm_1: it alone; "
        "algorithm_1_literal: line by line as printed; random: any pose",
    )

    arrangement: ArrangementConfig = ArrangementConfig()


class PlacementPlanners:
    """The planners of one scene: the configured one, and others built on their first request.

    Args:
        scene: container and objects; their poses do not matter.
        cell: the cell's physical facts.
        config: the variant that plans unless a request names another, and parameters.

    Raises:
        PackError: the new object does not fit into the container.
    """

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementPlannerConfig) -> None:
        self._scene, self._cell, self._config = scene, cell, config
        self._made: dict[str, PlacementPlanner] = {}
        self.of()

    def of(self, variant: str = "") -> PlacementPlanner:
        """The planner of a variant; empty: the configured one.

        Raises:
            PackError: there is no such variant.
        """
        name = variant or self._config.variant
        if name not in self._made:
            self._made[name] = PLACEMENT_PLANNERS[name](self._scene, self._cell, self._config)
        return self._made[name]
