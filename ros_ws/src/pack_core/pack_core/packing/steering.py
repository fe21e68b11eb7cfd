"""A body on springs to a place that a caller moves: an arm's push without the arm."""

from __future__ import annotations

import mujoco
import numpy as np

STIFFNESS = np.array([1000.0, 1000.0, 1000.0, 30.0, 30.0, 30.0])
"""[N/m] and [N m/rad]: what the driver's joint servos amount to at the held object, to a factor of two."""
DAMPING = np.array([80.0, 80.0, 80.0, 1.5, 1.5, 1.5])
"""[N s/m] and [N m s/rad]"""
LIMITS = np.array([15.0, 15.0, 15.0, 2.0, 2.0, 2.0])
"""Largest force [N] and torque [N m] of the springs."""
WORLD = "world_frame"


def add_steering(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> None:
    """Six actuators whose controls are the body's wanted position [m] and rotation vector [rad]."""
    spec.worldbody.add_site(name=WORLD)
    body.add_site(name=body.name)
    for i, gear in enumerate(np.eye(6)):
        actuator = spec.add_actuator(
            name=f"steering_{i}", target=body.name, refsite=WORLD, trntype=mujoco.mjtTrn.mjTRN_SITE,
            gear=gear, forcelimited=True, forcerange=(-LIMITS[i], LIMITS[i]),
        )  # fmt: skip
        actuator.set_to_position(kp=STIFFNESS[i], kv=DAMPING[i])
