"""The suction pump of the packing cell."""

from __future__ import annotations

import mujoco
import numpy as np
from pydantic import PositiveFloat

from pack_core.config import Config

CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
CUP_HEIGHT = 0.012
"""Height of the cup, the last part of the stem [m]."""
STEEL = (0.78, 0.80, 0.83, 1.0)
DARK = (0.16, 0.17, 0.19, 1.0)
ACCENT = (0.10, 0.45, 0.78, 1.0)
"""Colours of cup, stem and housing, RGBA."""


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


def add_pump(link: mujoco.MjsBody, pump: Pump, flange: float) -> mujoco.MjsBody:
    """Fix the pump to an arm's flange.

    Args:
        link: the arm's last link.
        pump: sizes and mass.
        flange: where the flange is, along the link's z axis [m].

    Returns:
        The body `tool`, whose origin is the cup and whose z axis points out of it.
    """
    tool = link.add_body(name="tool", pos=(0, 0, flange + pump.length), gravcomp=True)
    tool.mass, tool.ipos = pump.mass, (0, 0, -pump.stem_length - pump.body_length / 2)
    # a solid cylinder: m (3 r^2 + l^2) / 12 across its axis, m r^2 / 2 about it
    moments = pump.mass * np.array(
        [3 * pump.body_radius**2 + pump.body_length**2] * 2 + [6 * pump.body_radius**2]
    )
    tool.inertia, tool.explicitinertial = moments / 12, True
    top, neck = -pump.length, -pump.stem_length
    tool.add_geom(name="pump_body", type=CYLINDER, fromto=(0, 0, top, 0, 0, neck), rgba=STEEL, mass=0,
                  size=(pump.body_radius, 0, 0), contype=1, conaffinity=1, condim=3)  # fmt: skip
    _draw(tool, "pump_stem", (neck, -CUP_HEIGHT), 0.010, DARK)
    _draw(tool, "pump_cup", (-CUP_HEIGHT, 0), pump.cup_radius, ACCENT)
    ring = (neck - 0.6 * pump.body_length, neck - 0.5 * pump.body_length)
    _draw(tool, "pump_ring", ring, pump.body_radius + 0.001, ACCENT)
    return tool


def _draw(
    tool: mujoco.MjsBody, name: str, ends: tuple[float, float], radius: float, rgba: tuple[float, ...]
) -> None:
    """A cylinder about the tool's axis that touches nothing."""
    tool.add_geom(name=name, type=CYLINDER, fromto=(0, 0, ends[0], 0, 0, ends[1]), size=(radius, 0, 0),
                  rgba=rgba, mass=0, contype=0, conaffinity=0)  # fmt: skip
