"""A mast with a square suction pad."""

from __future__ import annotations

from typing import Literal, Self

import mujoco
import numpy as np
from pydantic import PositiveFloat, model_validator

from pack_core.robots.kr210 import ARM_CONTACT, DARK, STEEL
from pack_core.robots.surface_gripper import PAD_BIT, TOOL, GripperTool, Seal

PAD_THICKNESS = 0.02
PLATE_THICKNESS = 0.02
"""Thickness of the foam and of the plate that carries it [m]."""
FOAM = (0.10, 0.25, 0.55, 1.0)
"""Colour of the foam, RGBA."""
CYLINDER, BOX = mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_BOX
INSET = 0.8
"""Share of the pad's half side up to which a face must reach: foam seals a little inside its edge."""


class SquarePad(GripperTool):
    kind: Literal["square_pad"]
    mast_radius: PositiveFloat
    plate_radius: PositiveFloat
    pad_size: PositiveFloat

    @model_validator(mode="after")
    def _mast_hides_behind_the_pad(self) -> Self:
        if self.mast_radius * 2 > self.pad_size:
            raise ValueError(
                f"mast_radius is {self.mast_radius} m and pad_size {self.pad_size} m; "
                "allowed: a mast that is no wider than the pad"
            )
        return self

    def add_to(self, flange: mujoco.MjsBody, *, visuals: bool) -> mujoco.MjsBody:
        """The mast counts as an evenly filled cylinder; pad and plate have no mass of their own."""
        body = flange.add_body(name=TOOL, pos=(0, 0, self.length))
        body.mass, body.ipos = self.mass, (0, 0, -self.length / 2)
        across = self.mass * (3 * self.mast_radius**2 + self.length**2) / 12
        body.inertia = np.array([across, across, self.mass * self.mast_radius**2 / 2])
        body.explicitinertial = True
        half, top = self.pad_size / 2, -PAD_THICKNESS
        body.add_geom(name="pad", type=BOX, pos=(0, 0, top / 2), size=(half, half, PAD_THICKNESS / 2),
                      rgba=FOAM, mass=0, **{**ARM_CONTACT, "contype": PAD_BIT})  # fmt: skip
        body.add_geom(name="mast", type=CYLINDER, fromto=(0, 0, -self.length, 0, 0, top), mass=0, rgba=STEEL,
                      size=(self.mast_radius, 0, 0), **ARM_CONTACT)  # fmt: skip
        plate = (0, 0, -self.length, 0, 0, PLATE_THICKNESS - self.length)
        body.add_geom(name="tool_plate", type=CYLINDER, fromto=plate, size=(self.plate_radius, 0, 0),
                      rgba=DARK, mass=0, **ARM_CONTACT)  # fmt: skip
        if visuals:
            body.add_geom(type=BOX, pos=(0, 0, top - 0.006), size=(half, half, 0.006), rgba=DARK, mass=0,
                          contype=0, conaffinity=0)  # fmt: skip
        return body

    def seals(self) -> tuple[Seal, ...]:
        """The whole pad or nothing: its middle and its corners must be covered."""
        h = 0.5 * INSET * self.pad_size
        points = np.array([[0, 0, 0], [h, h, 0], [h, -h, 0], [-h, h, 0], [-h, -h, 0]], dtype=float)
        return (Seal(points, self.pad_size, "tool.pad_size"),)


GRIPPER = SquarePad
