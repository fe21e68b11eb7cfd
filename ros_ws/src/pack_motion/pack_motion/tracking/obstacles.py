"""Obstacles around the moving arm: who is seen, and what the policies react to, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from pack_core.motion.target import MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose, from_matrix, to_matrix
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import box_arrays
from pack_motion.rmpflow.parameters import Collision
from pack_motion.rmpflow.tree import ObstacleBoxes
from pack_motion.safety.separation_monitor import NOBODY, Seen


class MovingObstacles:
    """Keeps the newest observation, and makes the field of what the policies react to.

    Args:
        arm: the arm that moves among them.
        time: now [s].
        avoiding_distance: within which an obstacle that moves may drive the arm off its planned way [m].
    """

    def __init__(self, arm: MotionArm, time: float, avoiding_distance: float) -> None:
        self._arm, self._seen_at, self._avoiding_distance = arm, time, avoiding_distance
        self._seen: dict[str, Obstacle] = {}

    def observe(self, obstacles: Iterable[Obstacle], time: float) -> None:
        """Take an observation made at `time` [s]; obstacles that are not in it are gone."""
        self._seen, self._seen_at = {item.name: item for item in obstacles}, time

    def __bool__(self) -> bool:
        return bool(self._seen)

    def seen(self, time: float, target: MotionTarget) -> Seen:
        """Who moves, where they were when they were seen, and how long ago that is at `time` [s].

        Besides those who were observed, the obstacles of the target that move count.
        """
        known = {item.name: item for item in target.obstacles if item.is_moving} | self._seen
        if not known:
            return NOBODY
        return Seen(
            tuple(known),
            *box_arrays(tuple(known.values())),
            np.array([float(np.linalg.norm(item.v_WO_W)) for item in known.values()]),
            max(time - self._seen_at, 0.0) if self._seen else 0.0,
        )

    def field(
        self, time: float, target: MotionTarget, policy: Collision, q: Array, distance: float
    ) -> ObstacleField:
        """What a policy reacts to at `time` [s].

        Those seen are taken to go on at their velocities. Once one of them is near, the arm may leave its
        planned way, and what stands, and its own base, are felt, too.

        Args:
            time: now [s].
            target: with the obstacles that stand.
            policy: the policy.
            q: commanded joint positions `(n,)` [rad].
            distance: from the arm to the nearest of those that move [m].
        """
        age = max(time - self._seen_at, 0.0)
        moving = {name: item.after(age) for name, item in self._seen.items()}
        # What may be touched must not push the arm away from it.
        apart = (item for item in target.obstacles if item.name not in target.contacts)
        known = {item.name: item for item in apart} | moving
        is_avoiding = bool(moving) and distance < self._avoiding_distance
        around = [*known.values(), *(self._own_base(q) if is_avoiding else ())]
        return ObstacleField.of(around, policy, is_avoiding=is_avoiding)

    def _own_base(self, q: Array) -> Iterator[Obstacle]:
        """The arm's first link, which turns on its base, where it is now: its other links may run into it."""
        bodies = self._arm.bodies
        R, p = bodies.moved(*self._arm.chain.links(q))
        for i in np.flatnonzero(bodies.link == 0):
            yield Obstacle(bodies.names[i], Pose(p[i], from_matrix(R[i])), 2.0 * bodies.half[i])


@dataclass(frozen=True)
class ObstacleField:
    """The obstacles that the collision policy reacts to.

    Attributes:
        names: name of each obstacle.
        boxes: arrays of the obstacles, in the same order.
    """

    names: tuple[str, ...]
    boxes: ObstacleBoxes

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
