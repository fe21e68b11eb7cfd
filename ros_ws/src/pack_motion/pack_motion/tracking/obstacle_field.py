"""Obstacles as the arrays that the collision policy takes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.rotations import to_matrix
from pack_motion.rmpflow.parameters import Collision
from pack_motion.rmpflow.tree_arrays import ObstacleBoxes


@dataclass(frozen=True)
class ObstacleField:
    """The obstacles that the collision policy reacts to.

    Attributes:
        names: name of each obstacle.
        boxes: arrays of the obstacles, in the same order.
    """

    names: tuple[str, ...]
    boxes: ObstacleBoxes

    @property
    def fastest(self) -> float:
        """Speed of the fastest obstacle [m/s]; 0 where there is none."""
        return float(np.linalg.norm(self.boxes.v, axis=1).max(initial=0.0))

    @classmethod
    def of(
        cls, obstacles: Iterable[Obstacle], policy: Collision, *, is_avoiding: bool = False
    ) -> ObstacleField:
        """The obstacles for which the policy has a radius above 0; it ignores the others.

        Args:
            obstacles: the obstacles.
            policy: the policy.
            is_avoiding: whether the arm may leave its planned way for something that moves.
        """
        felt = [(item, _radius(item, policy, is_avoiding=is_avoiding)) for item in obstacles]
        felt = [(item, radius) for item, radius in felt if radius > 0.0]
        boxes = ObstacleBoxes(
            np.array([to_matrix(item.X_WO.q) for item, _ in felt]).reshape(-1, 3, 3),
            np.array([item.X_WO.p for item, _ in felt]).reshape(-1, 3),
            np.array([0.5 * item.size for item, _ in felt]).reshape(-1, 3),
            np.array([item.v_WO_W for item, _ in felt]).reshape(-1, 3),
            np.array([radius for _, radius in felt]),
            np.array([float(item.is_moving or policy.standing_radius > 0.0) for item, _ in felt]),
        )
        return cls(tuple(item.name for item, _ in felt), boxes)


def _radius(item: Obstacle, policy: Collision, *, is_avoiding: bool) -> float:
    if item.is_moving:
        speed = float(np.linalg.norm(item.v_WO_W))
        return policy.metric_modulation_radius + policy.radius_per_speed * speed
    return max(policy.standing_radius, policy.avoiding_radius if is_avoiding else 0.0)
