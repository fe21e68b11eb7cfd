"""State of a surface gripper, the load on its pad, and the limits at which it takes hold and lets go."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import Config

ASKED = "asked to open"
"""The reason of a gripper that was commanded to open, and of one that has not held anything yet."""


@dataclass(frozen=True)
class GripLoad:
    """Load on the pad.

    Attributes:
        coaxial: pull along the pad's axis [N]; negative where the box is pressed against the pad.
        shear: force across the pad's axis [N].
        moment: norm of the moment about the middle of the pad's face [N m].
    """

    coaxial: float = 0.0
    shear: float = 0.0
    moment: float = 0.0

    def worst(self, other: GripLoad) -> GripLoad:
        """The larger value of both loads in each component."""
        return GripLoad(
            max(self.coaxial, other.coaxial), max(self.shear, other.shear), max(self.moment, other.moment)
        )


@dataclass(frozen=True)
class PassedLimit:
    """A limit that a load exceeds: its key, the load, the allowed value, and the unit of both."""

    key: str
    load: float
    allowed: float
    unit: str

    @property
    def what(self) -> str:
        """The kind of load in words."""
        return self.key.replace("_", " ")


class GripLimits(Config):
    """The limits at which a surface gripper takes hold of a box and loses it."""

    max_grip_distance: PositiveFloat
    """How far a face may be from the pad along its axis [m]."""
    coaxial_force: PositiveFloat
    """Largest pull along the pad's axis [N]; pressing is no load."""
    shear_force: PositiveFloat
    """Largest force across the pad's axis [N]."""
    moment: PositiveFloat
    """Largest norm of the moment about the middle of the pad's face [N m]."""
    tolerated_steps: PositiveInt
    """Number of consecutive physics steps above a limit after which the gripper loses the box."""
    retry_interval: NonNegativeFloat
    """Time from one try to close to the next, where nothing was gripped [s]; 0: in every step."""
    retry_time: NonNegativeFloat = 1.0
    """How long tries go on [s]; 0: there is one."""
    carrying_acceleration: NonNegativeFloat
    """Largest acceleration of a carried box in any direction; orders are checked with it [m/s^2]."""

    def lifted(self) -> GripLimits:
        """The same gripper with limits of force and moment that nothing reaches."""
        return self.model_copy(update={"coaxial_force": 1e9, "shear_force": 1e9, "moment": 1e9})

    def passed_by(self, load: GripLoad, share: float) -> tuple[PassedLimit, ...]:
        """The limits that a load exceeds; `share` is the share of each limit that the seal can bear."""
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
        held: name of the box that it holds; empty when it holds none.
        is_closing: whether it is still trying to take hold.
        load: load on the pad in the last step.
        peak: largest loads since it took hold; kept after the release.
        reason: why it does not hold a box; empty while it holds one or is closing.
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
