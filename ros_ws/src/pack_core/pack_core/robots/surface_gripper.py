"""The surface gripper under a flange: a mast with a square suction pad."""

from __future__ import annotations

import mujoco
import numpy as np
from pydantic import PositiveFloat

from pack_core.config import Config
from pack_core.robots.kr210 import ARM_CONTACT
from pack_core.robots.kr210_shapes import DARK, STEEL

PAD_THICKNESS = 0.02
PLATE_THICKNESS = 0.02
FOAM = (0.10, 0.25, 0.55, 1.0)
CYLINDER, BOX = mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_BOX
TOOL = "tool"
PAD = "pad"


class GripperTool(Config):
    """The surface gripper under the flange: a mast with a square pad [m, kg]."""

    length: PositiveFloat
    mass: PositiveFloat
    mast_radius: PositiveFloat
    plate_radius: PositiveFloat
    pad_size: PositiveFloat


def add_surface_gripper(flange: mujoco.MjsBody, tool: GripperTool, *, look: bool) -> mujoco.MjsBody:
    """Add the gripper below the flange.

    Returns:
        The body `tool`, whose origin is the middle of the pad's face and whose z axis points out of it.
    """
    body = flange.add_body(name=TOOL, pos=(0, 0, tool.length))
    body.mass, body.ipos = tool.mass, (0, 0, -tool.length / 2)
    across = tool.mass * (3 * tool.mast_radius**2 + tool.length**2) / 12
    body.inertia = np.array([across, across, tool.mass * tool.mast_radius**2 / 2])
    body.explicitinertial = True
    half, top = tool.pad_size / 2, -PAD_THICKNESS
    body.add_geom(name=PAD, type=BOX, pos=(0, 0, top / 2), size=(half, half, PAD_THICKNESS / 2), rgba=FOAM,
                  mass=0, **{**ARM_CONTACT, "contype": 4})  # fmt: skip
    body.add_geom(name="mast", type=CYLINDER, fromto=(0, 0, -tool.length, 0, 0, top), mass=0, rgba=STEEL,
                  size=(tool.mast_radius, 0, 0), **ARM_CONTACT)  # fmt: skip
    plate = (0, 0, -tool.length, 0, 0, PLATE_THICKNESS - tool.length)
    body.add_geom(name="tool_plate", type=CYLINDER, fromto=plate, size=(tool.plate_radius, 0, 0), rgba=DARK,
                  mass=0, **ARM_CONTACT)  # fmt: skip
    if look:
        body.add_geom(type=BOX, pos=(0, 0, top - 0.006), size=(half, half, 0.006), rgba=DARK, mass=0,
                      contype=0, conaffinity=0)  # fmt: skip
    return body
