"""The suction pump of the packing cell."""

from __future__ import annotations

from pydantic import PositiveFloat

from pack_core.config import Config


class Pump(Config):
    """The suction pump under the flange: a cylindrical body, a stem and a cup [m, kg]."""

    mass: PositiveFloat
    body_radius: PositiveFloat
    body_length: PositiveFloat
    stem_length: PositiveFloat
    cup_radius: PositiveFloat

    @property
    def length(self) -> float:
        """Flange to cup [m]."""
        return self.body_length + self.stem_length
