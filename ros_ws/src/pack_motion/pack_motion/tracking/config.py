"""Named sets of motion parameters: `config/motion/<name>.yaml`."""

from __future__ import annotations

from enum import Enum
from functools import cache

from pydantic import Field, PositiveFloat

from pack_core.config import Config, load_config
from pack_core.errors import ConfigError
from pack_core.motion.moves import Mode
from pack_core.paths import config_path
from pack_motion.rmpflow.parameters import Policies
from pack_motion.safety.protective_distance import ProtectiveSeparation


class Reference(Enum):
    """The kind of reference that attracts the policies."""

    SHAPED = "shaped"
    """A moving, jerk-limited reference that every joint can follow."""
    STATIC = "static"
    """The end of each segment, at once."""


class Resolve(Enum):
    """How the summed policies are resolved into joint accelerations."""

    WITHIN_LIMITS = "within_limits"
    """A quadratic program within each joint's limits."""
    NORM_CAP = "norm_cap"
    """The pseudo-inverse, scaled down to a largest norm."""


class Waiting(Config):
    """When the reference waits for a tool that is held up."""

    near: PositiveFloat = Field(description="distance of the tool up to which it does not wait [m]")
    far: PositiveFloat = Field(description="distance at which it stands still [m]")
    time: PositiveFloat = Field(description="from standing still to full rate, at least [s]")
    calm_time: PositiveFloat = Field(
        description="after it kept its distance from somebody, for which the tool may be on its way back [s]"
    )


class Stuck(Config):
    """When a move counts as stuck."""

    waiting: PositiveFloat = Field(description="time that the reference may stand still [s]")
    giving_way: PositiveFloat = Field(description="the same, while it keeps its distance from somebody [s]")
    settling: PositiveFloat = Field(description="time from the reference's end to the target [s]")


class MotionSet(Config):
    """One named set of motion parameters."""

    reference: Reference
    resolve: Resolve
    max_acceleration_norm: PositiveFloat = Field(description="of the norm cap [rad/s^2]")
    substep: PositiveFloat = Field(description="longest step of the policies [s]")
    first_sphere_link: int = Field(ge=0, description="links from here on (0: the first) avoid obstacles")
    clearance: PositiveFloat = Field(description="of moves that are checked before they start [m]")
    limit_share: PositiveFloat = Field(le=1, description="of the joint limits that references use")
    avoiding_distance: PositiveFloat = Field(
        description="of an obstacle that moves, within which the arm may leave its planned way [m]"
    )
    waiting: Waiting
    separation: ProtectiveSeparation
    stuck: Stuck
    fast: Policies
    slow: Policies

    def policies(self, mode: Mode) -> Policies:
        """The parameters of the policies for a mode."""
        return self.fast if mode is Mode.FAST else self.slow


@cache
def motion_set(name: str) -> MotionSet:
    """The motion set `config/motion/<name>.yaml`; raises ConfigError when there is no such set."""
    path = config_path("motion", f"{name}.yaml")
    if not path.is_file():
        known = sorted(file.stem for file in config_path("motion").glob("*.yaml"))
        raise ConfigError(f"no motion set '{name}'; there are: {', '.join(known)} (config/motion)")
    return load_config(MotionSet, path)
