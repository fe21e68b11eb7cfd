"""The methods that a packing goal can ask for: PackItIn and its two baselines (section IV-A).

Each baseline lacks one of the two things that PackItIn knows:

| method | where the object shall go | objects on the way there |
|---|---|---|
| PackItIn | Algorithm 1, then rehearsed entries | all |
| Uninformed Pose | anywhere in the container, at random | all |
| Uninformed Physics | Algorithm 1 alone | none: straight down, upright |
"""

from __future__ import annotations

from enum import Enum

from pack_core.errors import ConfigError


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
