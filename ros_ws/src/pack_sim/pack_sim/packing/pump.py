"""The suction pump: the load on its cup, and when it lets go of the object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.packing.cell import Suction
from pack_core.rotations import Array

FILTER_TIME = 0.005
"""Time constant of the load filter [s]."""


@dataclass(frozen=True)
class Load:
    """Load on the cup: pull along its axis and shear [N], bending moment [N m]."""

    pull: float = 0.0
    shear: float = 0.0
    moment: float = 0.0


@dataclass(frozen=True)
class PumpState:
    """State of the pump; `release_reason` says why it opened, empty while it is closed."""

    is_closed: bool
    load: Load = Load()
    release_reason: str = ""


class PumpModel:
    """Filters the load on the cup and lets go when it exceeds what suction can hold."""

    def __init__(self, suction: Suction, timestep: float, *, is_closed: bool = True) -> None:
        self._suction = suction
        self._gain = timestep / (FILTER_TIME + timestep)
        self.state = PumpState(is_closed, release_reason="" if is_closed else "nothing was gripped yet")

    def update(self, force: Array, torque: Array) -> bool:
        """Update with the force [N] and torque [N m] on the cup, each `(3,)` in its frame, z along the pull.

        Returns:
            Whether the pump still holds the object.
        """
        fx, fy, pull = force.tolist()
        tx, ty, _ = torque.tolist()
        old, g = self.state.load, self._gain
        load = Load(
            old.pull + g * (pull - old.pull),
            old.shear + g * (float(np.hypot(fx, fy)) - old.shear),
            old.moment + g * (float(np.hypot(tx, ty)) - old.moment),
        )
        reason = self._excess(load)
        self.state = PumpState(self.state.is_closed, load, self.state.release_reason)
        if reason:
            self.open(reason)
        return not reason

    def open(self, reason: str) -> None:
        """Release the object; `reason` is reported in the state."""
        self.state = PumpState(is_closed=False, release_reason=reason)

    def close(self) -> None:
        """Hold the object from now on."""
        self.state = PumpState(is_closed=True)

    def _excess(self, load: Load) -> str:
        limits = self._suction
        for what, value, limit, unit in (
            ("pull", load.pull, limits.pull, "N"), ("shear", load.shear, limits.shear, "N"),
            ("moment", load.moment, limits.moment, "N m"),
        ):  # fmt: skip
            if value > limit:
                return f"{what} {value:.1f} {unit} above {limit:.1f} {unit}"
        return ""
