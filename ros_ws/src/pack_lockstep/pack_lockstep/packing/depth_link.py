"""Depth cameras and what perceives by them, in lockstep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_perception.perception_config import PerceptionConfig
from pack_sim.packing.depth_cameras import DepthCameraSystem
from pack_sim.packing.simulator import Simulator


@dataclass(frozen=True)
class DepthLink:
    """Depth cameras and the estimator that their images go to."""

    cameras: DepthCameraSystem
    estimator: DepthEstimator

    @classmethod
    def of(cls, description: Scene, cell: PackingCell, config: PerceptionConfig, seed: int) -> DepthLink:
        """Cameras and an estimator that begins with a scene as it is described."""
        cameras = DepthCameraSystem(cell.depth, np.random.default_rng([seed, 2]))
        return cls(cameras, DepthEstimator(description, cell, config))

    def step(self, simulator: Simulator) -> None:
        """Expose if it is time, and deliver what is due."""
        self.cameras.update(simulator.model, simulator.data, simulator.time)
        for frame in self.cameras.due(simulator.time):
            self.estimator.see(frame)
