"""What a surface gripper says about its grip, and how much of a load it bears."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import Config

ASKED = "asked to open"
"""Reason of a gripper that was told to let go, and of one that never held anything."""


@dataclass(frozen=True)
class GripLoad:
    """Load on the pad.

    Attributes:
        coaxial: pull along the pad's axis [N]; negative where the box is pressed against it.
        shear: across the axis [N].
        moment: about the middle of the pad's face, all axes together [N m].
    """

    coaxial: float = 0.0
    shear: float = 0.0
    moment: float = 0.0

    def worst(self, other: GripLoad) -> GripLoad:
        """The larger of both in every respect."""
        return GripLoad(
            max(self.coaxial, other.coaxial), max(self.shear, other.shear), max(self.moment, other.moment)
        )


@dataclass(frozen=True)
class PassedLimit:
    """A limit that a load passes: its key, the load, what is allowed, and their unit."""

    key: str
    load: float
    allowed: float
    unit: str

    @property
    def what(self) -> str:
        """The kind of load in words."""
        return self.key.replace("_", " ")


class GripLimits(Config):
    """When a surface gripper takes hold and when it lets go."""

    max_grip_distance: PositiveFloat
    """How far a face may be from the pad along its axis [m]."""
    coaxial_force: PositiveFloat
    """Pull along the pad's axis [N]; pressing is no load."""
    shear_force: PositiveFloat
    """Across the pad's axis [N]."""
    moment: PositiveFloat
    """About the middle of the pad's face, all axes together [N m]."""
    tolerated_steps: PositiveInt
    """Steps in a row, of the physics, above a limit before it lets go."""
    retry_interval: NonNegativeFloat
    """How long closing goes on trying [s]; 0: once."""
    carrying_acceleration: NonNegativeFloat
    """At which boxes are carried, at most and in any direction; orders are checked with it [m/s^2]."""

    def passed_by(self, load: GripLoad, share: float) -> tuple[PassedLimit, ...]:
        """The limits that a load passes on a seal that bears a share of them."""
        rows = (
            ("coaxial_force", load.coaxial, share * self.coaxial_force, "N"),
            ("shear_force", load.shear, share * self.shear_force, "N"),
            ("moment", load.moment, share * self.moment, "N m"),
        )
        return tuple(PassedLimit(*row) for row in rows if row[1] > row[2])


@dataclass(frozen=True)
class GripState:
    """The gripper now.

    Attributes:
        held: name of the box that it holds; empty when none.
        is_closing: whether it is still trying to take hold.
        load: on the pad in the last step.
        peak: worst loads since it took hold, kept after it let go.
        reason: why it does not hold; empty while it holds or tries.
    """

    held: str = ""
    is_closing: bool = False
    load: GripLoad = GripLoad()
    peak: GripLoad = GripLoad()
    reason: str = ""

    @property
    def is_closed(self) -> bool:
        """Whether it holds a box."""
        return bool(self.held)

    @property
    def is_open(self) -> bool:
        """Whether it neither holds a box nor tries to."""
        return not self.held and not self.is_closing
