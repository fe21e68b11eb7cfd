"""A body pulled by springs to a pose that the caller commands: stands for the arm's push, without an arm."""

from __future__ import annotations

import mujoco
import numpy as np

STIFFNESS = np.array([1000.0, 1000.0, 1000.0, 30.0, 30.0, 30.0])
"""[N/m] and [N m/rad]: what the driver's joint servos give the held object, within a factor of two."""
DAMPING = np.array([80.0, 80.0, 80.0, 1.5, 1.5, 1.5])
"""Damping along and about the world's axes [N s/m] and [N m s/rad]."""
WORLD = "world_frame"


def add_steering(spec: mujoco.MjSpec, body: mujoco.MjsBody, force: float, moment: float) -> None:
    """Add six actuators whose controls are the body's desired position [m] and rotation vector [rad].

    Along each axis they pull with up to `force` [N], and turn about it with up to `moment` [N m].
    """
    limits = np.repeat([force, moment], 3)
    spec.worldbody.add_site(name=WORLD)
    body.add_site(name=body.name)
    # gear k selects direction k of the site's transform: three translations, then three rotations
    for i, gear in enumerate(np.eye(6)):
        actuator = spec.add_actuator(
            name=f"steering_{i}", target=body.name, refsite=WORLD, trntype=mujoco.mjtTrn.mjTRN_SITE,
            gear=gear, forcelimited=True, forcerange=(-limits[i], limits[i]),
        )  # fmt: skip
        actuator.set_to_position(kp=STIFFNESS[i], kv=DAMPING[i])
