"""The interface of every suction gripper under a flange: a body of the model, and the seals that it has.

The kinds of gripper are in `pack_core/robots/grippers/`, one file for each.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import mujoco
from pydantic import PositiveFloat

from pack_core.config import Config, validate_config
from pack_core.errors import ConfigError
from pack_core.robots import grippers
from pack_core.rotations import Array

TOOL = "tool"
"""Name of the gripper's body in every model."""
PAD_BIT = 4
"""The contype bit of a pad. It is removed from the conaffinity of a box that is held."""


@dataclass(frozen=True)
class Seal:
    """One way in which a gripper can hold a face.

    Attributes:
        points: points of the pad in the tool's frame `(k, 3)` [m]; all must meet the face of one box.
        side: edge of the smallest square face that it fits on, however it is turned [m].
        key: key of the configuration that sets its size, for messages.
        share: share of the limits under `grip` that it can bear.
    """

    points: Array
    side: float
    key: str
    share: float = 1.0


class GripperTool(Config, ABC):
    """The facts of a gripper under the flange [m, kg]: section `tool` of the cell."""

    kind: str
    """Name of its module in `pack_core/robots/grippers/`."""
    length: PositiveFloat
    """Distance from the flange to the face of the pad [m]."""
    mass: PositiveFloat

    @abstractmethod
    def add_to(self, flange: mujoco.MjsBody, *, visuals: bool) -> mujoco.MjsBody:
        """Add the gripper below the flange.

        Args:
            flange: the arm's flange, whose z axis points out of the arm.
            visuals: whether shapes that are only drawn are added.

        Returns:
            The body `TOOL`, whose origin is the middle of the pad's face and whose z axis points out of it.
            Its geoms have the bits of `kr210.ARM_CONTACT`, those of the pad the contype `PAD_BIT`.
        """

    @abstractmethod
    def seals(self) -> tuple[Seal, ...]:
        """The ways in which it can hold a face, the largest first; the first one that fits is used."""


def gripper_tool(values: Mapping[str, Any], source: str) -> GripperTool:
    """The gripper that a section of the configuration describes.

    Args:
        values: section `tool` of a cell; `kind` names the module that has the gripper class as `GRIPPER`.
        source: where the section is from, for errors.

    Raises:
        ConfigError: there is no such kind, or a key or value is not allowed.
    """
    kinds = sorted(module.name for module in iter_modules(grippers.__path__))
    kind = values.get("kind")
    if kind not in kinds:
        raise ConfigError(f"{source}: key 'kind' is {kind!r}; allowed: {', '.join(kinds)}")
    cls: type[GripperTool] = import_module(f"{grippers.__name__}.{kind}").GRIPPER
    return validate_config(cls, values, source)
