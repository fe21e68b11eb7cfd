"""How the arm's joints are driven in a model."""

from __future__ import annotations

from typing import Annotated

import mujoco
from pydantic import Field

from pack_core.config import Config
from pack_core.robots.panda import JOINTS, TORQUE_LIMITS

Joints = Annotated[tuple[float, ...], Field(min_length=7, max_length=7)]

GUIDED_ARMATURE = 1e4


class Robot(Config):
    """The arm's start and the gains of its low-level controller (Eq. 4)."""

    home: Joints
    stiffness: Joints
    damping: Joints


def add_motors(spec: mujoco.MjSpec) -> None:
    """A torque actuator on every joint, with the published limit; controls are torques `(7,)` [N m]."""
    for name, limit in zip(JOINTS, TORQUE_LIMITS, strict=True):
        _add(spec, name, name, ctrllimited=True, ctrlrange=(-limit, limit)).set_to_motor()


def add_servos(spec: mujoco.MjSpec, robot: Robot) -> None:
    """The driver's law inside the model, where the integrator treats its damping implicitly (Eq. 4).

    Controls are desired positions and velocities `(14,)` [rad, rad/s]; the sum of both torques is
    limited as the driver limits it.
    """
    for i, name in enumerate(JOINTS):
        spec.joint(name).actfrclimited = True
        spec.joint(name).actfrcrange = (-TORQUE_LIMITS[i], TORQUE_LIMITS[i])
        _add(spec, f"{name}_position", name).set_to_position(kp=robot.stiffness[i])
    for i, name in enumerate(JOINTS):
        _add(spec, f"{name}_velocity", name).set_to_velocity(kv=robot.damping[i])


def make_heavy(spec: mujoco.MjSpec) -> None:
    """Joints that contacts do not move, for a caller that sets their positions and velocities."""
    for name in JOINTS:
        spec.joint(name).armature = GUIDED_ARMATURE


def _add(spec: mujoco.MjSpec, name: str, joint: str, **settings: object) -> mujoco.MjsActuator:
    return spec.add_actuator(name=name, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT, **settings)
