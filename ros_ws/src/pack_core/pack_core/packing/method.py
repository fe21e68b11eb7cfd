"""The methods that a packing goal can ask for: PackItIn and its two baselines (section IV-A)."""

from __future__ import annotations

from enum import Enum

from pack_core.errors import ConfigError


class PackingMethod(Enum):
    """A packing method; the values are its names in goals, options and results."""

    PACK_IT_IN = "pack_it_in"
    UNINFORMED_POSE = "uninformed_pose"
    UNINFORMED_PHYSICS = "uninformed_physics"

    @classmethod
    def of(cls, name: str) -> PackingMethod:
        """The method called `name`.

        Raises:
            ConfigError: there is none.
        """
        try:
            return cls(name)
        except ValueError:
            raise ConfigError(f"method '{name}'; allowed: {', '.join(m.value for m in cls)}") from None

    @property
    def placement_variant(self) -> str:
        """Name of the placement planner that the method needs; empty: the configured one."""
        return "random" if self is PackingMethod.UNINFORMED_POSE else ""

    @property
    def knows_objects(self) -> bool:
        """Whether the controller's model contains the objects in the container."""
        return self is not PackingMethod.UNINFORMED_PHYSICS
