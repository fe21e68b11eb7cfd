"""What goals of the packing cell ask for, and how they end.

A goal asks for PackItIn or for one of its two baselines (section IV-A), each of which lacks one of the two
things that PackItIn knows:

| method | where the object shall go | objects on the way there |
|---|---|---|
| PackItIn | Algorithm 1, then rehearsed entries | all |
| Uninformed Pose | anywhere in the container, at random | all |
| Uninformed Physics | Algorithm 1 alone | none: straight down, upright |

A fill job asks for a method by which places are chosen for the objects of a list.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from pack_core.errors import ConfigError
from pack_core.rotations import Pose


class PackingMethod(Enum):
    """A packing method; the values are its names in goals, options and results.

    The paper's words in section IV-A:

    - Uninformed Pose "does not use the placement planner as described in Alg. 1, instead it simply randomly
      chooses a packing pose inside the container. Importantly it still adds any corresponding objects in
      collision with the packing pose to the collision list G."
    - Uninformed Physics "still receives an informative packing pose from Alg. 1, however, during trajectory
      optimization, it does not consider the physical interactions between objects in the container and O_new.
      This is achieved by removing the objects from the simulated container and not tracking their poses from
      the vision system."
    """

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
        return _VARIANTS[self]

    @property
    def knows_objects(self) -> bool:
        """Whether the motion to the packing pose takes the objects in the container into account.

        If not, they are missing from the controller's model, and the entry, its tilt and the collision list's
        repulsion do not depend on them. The container itself, and the height above it from which every entry
        starts (Eq. 5), are known to all methods.
        """
        return self is not PackingMethod.UNINFORMED_PHYSICS


_VARIANTS = {
    PackingMethod.PACK_IT_IN: "",
    PackingMethod.UNINFORMED_POSE: "random",
    # A rehearsed entry is chosen by simulating the very contacts that this baseline must not know.
    PackingMethod.UNINFORMED_PHYSICS: "algorithm_1",
}


class PackingExitReason(Enum):
    """How a goal ended; `UNFINISHED` where a recording stops before its end."""

    PLACED = "placed"
    TIMEOUT = "timeout"
    DETACHED = "detached"
    FORCE = "force"
    NO_PLACEMENT = "no_placement"
    CANCELED = "canceled"
    FAULT = "fault"
    UNFINISHED = "unfinished"


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
