"""Franka Emika Panda with a suction pump, as an MjSpec subtree built from primitives.

Kinematics: the manufacturer's modified DH table. Inertias: Gaz, Cognetti, Oliva, Robuffo Giordano,
De Luca, "Dynamic identification of the Franka Emika Panda robot with retrieval of feasible
parameters using penalty-based optimization", IEEE RA-L 4(4), 2019. Capsules: the manufacturer's
coarse collision model.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.robots.pump import Pump

JOINTS = tuple(f"panda_joint{i}" for i in range(1, 8))
LOWER = np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973])
UPPER = np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973])
VELOCITY_LIMITS = np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])
TORQUE_LIMITS = np.array([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0])
PAYLOAD = 3.0
"""What the flange may carry [kg]."""
REACH = (0.2, 0.75)
"""Nearest x and farthest horizontal distance from the base at which the tool works pointing down [m]."""
FLANGE = 0.107
"""Last joint to flange [m]."""

WHITE = (0.93, 0.94, 0.95, 1.0)
DARK = (0.16, 0.17, 0.19, 1.0)
ACCENT = (0.10, 0.45, 0.78, 1.0)
CAPSULE = mujoco.mjtGeom.mjGEOM_CAPSULE
CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
ROTATE_X = (0.7071067811865476, 0.7071067811865476, 0.0, 0.0)
ROTATE_MINUS_X = (0.7071067811865476, -0.7071067811865476, 0.0, 0.0)


@dataclass(frozen=True)
class Link:
    """One link: where it hangs on the last one, its inertia, and the capsules that draw it."""

    pos: tuple[float, float, float]
    quat: tuple[float, float, float, float]
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]
    """About the centre of mass: xx, yy, zz, xy, xz, yz [kg m^2]."""
    capsules: tuple[tuple[float, tuple[float, ...]], ...]
    """Radius and end points [m]."""


UNROTATED = (1.0, 0.0, 0.0, 0.0)
LINKS = (
    Link((0, 0, 0.333), UNROTATED, 4.970684, (0.003875, 0.002081, -0.04762),
         (0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169),
         ((0.06, (0, 0, -0.333, 0, 0, -0.05)),)),
    Link((0, 0, 0), ROTATE_MINUS_X, 0.646926, (-0.003141, -0.02872, 0.003495),
         (0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704),
         ((0.06, (0, 0, -0.06, 0, 0, 0.06)),)),
    Link((0, -0.316, 0), ROTATE_X, 3.228604, (0.027518, 0.039252, -0.066502),
         (0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805),
         ((0.06, (0, 0, -0.22, 0, 0, -0.07)),)),
    Link((0.0825, 0, 0), ROTATE_X, 3.587895, (-0.05317, 0.104419, 0.027454),
         (0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641),
         ((0.06, (0, 0, -0.06, 0, 0, 0.06)),)),
    Link((-0.0825, 0.384, 0), ROTATE_MINUS_X, 1.225946, (-0.011953, 0.041065, -0.038437),
         (0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229),
         ((0.06, (0, 0, -0.31, 0, 0, -0.21)), (0.03, (0, 0.08, -0.20, 0, 0.08, -0.06)))),
    Link((0, 0, 0), ROTATE_X, 1.666555, (0.060149, -0.014117, -0.010517),
         (0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341),
         ((0.05, (0, 0, -0.07, 0, 0, 0.01)), (0.045, (0.03, 0, 0, 0.088, 0, 0)))),
    Link((0.088, 0, 0), ROTATE_X, 0.735522, (0.010517, -0.004252, 0.061597),
         (0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741),
         ((0.045, (0, 0, -0.01, 0, 0, 0.065)),)),
)  # fmt: skip


def add_panda(spec: mujoco.MjSpec, pump: Pump, *, gravcomp: bool = True) -> mujoco.MjsBody:
    """Add the arm with its pump at the world's origin.

    Args:
        spec: the model under construction.
        pump: the tool.
        gravcomp: compensate the weight of the links and the tool, as the robot's driver does.

    Returns:
        The body `tool`, whose origin is the cup and whose z axis points out of it.
    """
    parent = spec.worldbody.add_body(name="panda_link0")
    _draw(parent, ((0.06, (-0.09, 0, 0.06, -0.06, 0, 0.06)), (0.065, (0, 0, 0.05, 0, 0, 0.12))), DARK)
    for i, link in enumerate(LINKS):
        parent = parent.add_body(name=f"panda_link{i + 1}", pos=link.pos, quat=link.quat, gravcomp=gravcomp)
        parent.mass, parent.ipos, parent.fullinertia = link.mass, link.com, link.inertia
        parent.explicitinertial = True
        parent.add_joint(
            name=JOINTS[i], type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1), range=(LOWER[i], UPPER[i]),
            limited=True, damping=1.0, armature=0.1,
        )  # fmt: skip
        _draw(parent, link.capsules, WHITE)
        _draw_joint(parent, 0.062 if i < 5 else 0.047, ACCENT if i in (1, 3) else DARK)
    return _add_pump(parent, pump, gravcomp)


def _add_pump(link7: mujoco.MjsBody, pump: Pump, gravcomp: bool) -> mujoco.MjsBody:
    tool = link7.add_body(name="tool", pos=(0, 0, FLANGE + pump.length), gravcomp=gravcomp)
    tool.mass, tool.ipos = pump.mass, (0, 0, -pump.stem_length - pump.body_length / 2)
    moments = pump.mass * np.array(
        [3 * pump.body_radius**2 + pump.body_length**2] * 2 + [6 * pump.body_radius**2]
    )
    tool.inertia, tool.explicitinertial = moments / 12, True
    top, neck = -pump.length, -pump.stem_length
    collide = dict(contype=1, conaffinity=1, condim=3)
    tool.add_geom(name="pump_body", type=CYLINDER, fromto=(0, 0, top, 0, 0, neck),
                  size=(pump.body_radius, 0, 0), rgba=(0.78, 0.80, 0.83, 1), mass=0, **collide)  # fmt: skip
    tool.add_geom(name="pump_stem", type=CYLINDER, fromto=(0, 0, neck, 0, 0, -0.012),
                  size=(0.010, 0, 0), rgba=DARK, mass=0, contype=0, conaffinity=0)  # fmt: skip
    tool.add_geom(name="pump_cup", type=CYLINDER, fromto=(0, 0, -0.012, 0, 0, 0),
                  size=(pump.cup_radius, 0, 0), rgba=ACCENT, mass=0, contype=0, conaffinity=0)  # fmt: skip
    ring = (neck - 0.6 * pump.body_length, neck - 0.5 * pump.body_length)
    tool.add_geom(type=CYLINDER, fromto=(0, 0, ring[0], 0, 0, ring[1]), rgba=ACCENT, mass=0,
                  size=(pump.body_radius + 0.001, 0, 0), contype=0, conaffinity=0)  # fmt: skip
    return tool


def _draw(
    body: mujoco.MjsBody, capsules: tuple[tuple[float, tuple[float, ...]], ...], rgba: tuple[float, ...]
) -> None:
    for radius, ends in capsules:
        body.add_geom(
            type=CAPSULE, fromto=ends, size=(radius, 0, 0), rgba=rgba, contype=0, conaffinity=0, mass=0
        )


def _draw_joint(body: mujoco.MjsBody, radius: float, rgba: tuple[float, ...]) -> None:
    body.add_geom(type=CYLINDER, fromto=(0, 0, -0.03, 0, 0, 0.03), size=(radius + 0.003, 0, 0), rgba=rgba,
                  contype=0, conaffinity=0, mass=0)  # fmt: skip
