"""How a container is filled from a list: the methods, and what a planner says about the list's objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from pack_core.errors import ConfigError
from pack_core.rotations import Pose


class FillMethod(Enum):
    """How places are chosen: with contact, or by a baseline without it or without a plan."""

    CONTACT = "contact"
    """Objects stand close together, and what is in the way is pushed aside."""
    NO_CONTACT = "no_contact"
    """Objects keep so much distance that none touches another on its way down."""
    RANDOM = "random"
    """Objects come as the list has them, and each is wanted at a random place."""

    @classmethod
    def of(cls, name: str) -> FillMethod:
        """The method called `name`; empty: contact.

        Raises:
            ConfigError: there is none.
        """
        try:
            return cls(name) if name else cls.CONTACT
        except ValueError:
            raise ConfigError(f"method '{name}'; allowed: {', '.join(m.value for m in cls)}") from None

    @property
    def placement_variant(self) -> str:
        """Name of the placement planner that chooses the pose of a goal."""
        return {"contact": "physics", "no_contact": "algorithm_1", "random": "random"}[self.value]


@dataclass(frozen=True)
class Arrangement:
    """Where the remaining objects of a list shall stand.

    Attributes:
        order: names in the order in which they are to be packed.
        poses: X_WO of those that have a place; the others go wherever they disturb least.
        refused: those that do not fit any more, with the reason.
    """

    order: tuple[str, ...]
    poses: Mapping[str, Pose] = field(default_factory=dict)
    refused: Mapping[str, str] = field(default_factory=dict)
