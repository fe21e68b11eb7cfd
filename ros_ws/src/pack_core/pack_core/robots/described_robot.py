"""A robot without its surroundings: model, links, joints, and its description as URDF."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from pack_core.robots.urdf import bodies_below, robot_description


@dataclass(frozen=True)
class DescribedRobot:
    """A robot as it is told to viewers.

    Attributes:
        model: the robot alone, with the shapes that pictures show.
        links: names of its links, the base first; they are frames in /tf.
        joints: names of its joints, fingers included.
        urdf: the same as URDF.
    """

    model: mujoco.MjModel
    links: tuple[str, ...]
    joints: tuple[str, ...]
    urdf: str

    @classmethod
    def of(cls, spec: mujoco.MjSpec, name: str) -> DescribedRobot:
        """The robot of a specification that holds nothing else.

        Args:
            spec: its first body is fixed to the world.
            name: of the robot.

        Raises:
            ConfigError: URDF cannot express a body's joints.
        """
        model = spec.compile()
        root = model.body(1).name  # body 0 is the world
        links = tuple(model.body(body).name for body in bodies_below(model, root))
        joints = tuple(model.joint(joint).name for joint in range(model.njnt))
        return cls(model, links, joints, robot_description(model, root, name))
