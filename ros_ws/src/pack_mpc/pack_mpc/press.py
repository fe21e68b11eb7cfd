"""Pressing: a force down on the held object, stated as torque, while it halts on a rehearsed entry.

What bears the object often gives way to more force than the cost asks for, which within its horizon sees no
use in it. Rehearsals push as hard as the arm may (`push` in `config/cells/packing.yaml`); so does the arm.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.joints import Setpoints
from pack_mpc.plant import PackingPlant


class PressConfig(Config):
    """How the force builds up at a halt."""

    force: NonNegativeFloat = Field(default=22.0, description="largest force down at a halt [N]; 0: none")
    rate: PositiveFloat = Field(default=40.0, description="by how much it grows each second [N/s]")
    delay: NonNegativeFloat = Field(default=0.15, description="length of a halt from which on it grows [s]")

    def after(self, halt: float) -> float:
        """The force down [N] once the object has made no progress for `halt` [s]."""
        return min(self.force, self.rate * max(halt - self.delay, 0.0))


def pressing(plant: PackingPlant, setpoints: Setpoints, force: float) -> Setpoints:
    """The same setpoints with torques that press the held object down with `force` [N] more.

    A force f on the object takes the joint torques J' f, J the Jacobian of its position where the setpoints
    begin. The torques stay within the arm's limits.
    """
    if not force:
        return setpoints
    limit = plant.arm.limits.effort
    down = plant.held_jacobian(setpoints.q[0])[:3].T @ np.array([0.0, 0.0, -force])
    return replace(setpoints, tau=np.clip(setpoints.tau + down, -limit, limit))
