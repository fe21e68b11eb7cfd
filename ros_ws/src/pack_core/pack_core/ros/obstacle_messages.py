"""Obstacles of an arm, to messages and back."""

from __future__ import annotations

from collections.abc import Iterable

from pack_interfaces.msg import BoxObstacle, BoxObstacles

from pack_core.motion.world import Obstacle
from pack_core.ros.conversions import WORLD, from_pose, from_vector, to_pose, to_stamp, to_vector


def to_obstacle(item: Obstacle) -> BoxObstacle:
    """A message of an obstacle."""
    return BoxObstacle(
        name=item.name, pose=to_pose(item.X_WO), size=to_vector(item.size),
        velocity=to_vector(item.v_WO_W), is_moving=item.is_moving,
    )  # fmt: skip


def to_obstacles(obstacles: Iterable[Obstacle], time: float) -> BoxObstacles:
    """A message of moving obstacles as they were seen at `time` [s]."""
    message = BoxObstacles(obstacles=[to_obstacle(item) for item in obstacles])
    message.header.stamp, message.header.frame_id = to_stamp(time), WORLD
    return message


def from_obstacles(messages: Iterable[BoxObstacle]) -> tuple[Obstacle, ...]:
    """The obstacles in messages; MessageError or PackError where one has values that must not be used."""
    return tuple(
        Obstacle(
            item.name, from_pose(item.pose), from_vector(item.size, f"size of {item.name}"),
            from_vector(item.velocity, f"velocity of {item.name}"), item.is_moving,
        )
        for item in messages
    )  # fmt: skip
