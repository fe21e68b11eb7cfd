"""How an arm's joints are driven in a model."""

from __future__ import annotations

from typing import Annotated

import mujoco
from pydantic import Field, field_validator, model_validator

from pack_core.config import Config
from pack_core.robots.packing_arms import PACKING_ARMS
from pack_core.robots.seven_axis_arm import ELBOW, SevenAxisArm
from pack_core.rotations import Array

Joints = Annotated[tuple[float, ...], Field(min_length=7, max_length=7)]

GUIDED_ARMATURE = 1e4
"""Inertia added to joints that contacts shall not move [kg m^2]; the arm's own is a few kg m^2."""
BENT = 0.25
"""By how much the elbow stays bent [rad]. Of the Panda's reach of 0.72 m this takes 6 mm."""


class ArmDrive(Config):
    """The cell's arm: its model, where it starts, and the gains of its low-level controller (Eq. 4).

    Attributes:
        model: name of the arm, one of `pack_core.robots.packing_arms`.
        home: joint positions at the start [rad].
        stiffness: position gain of each joint [N m/rad], with which the controller's model pushes.
        damping: velocity gain of each joint [N m s/rad], likewise.
        feedback: share of these gains that the driver applies. The push itself comes as feed-forward torque,
            so a lower share makes the arm yield to what no plan foresaw.
    """

    model: str = "panda"
    home: Joints
    stiffness: Joints
    damping: Joints
    feedback: float = Field(default=1.0, gt=0, le=1)

    @property
    def applied(self) -> ArmDrive:
        """The drive with the gains that the driver applies."""
        share = {
            name: tuple(self.feedback * gain for gain in getattr(self, name))
            for name in ("stiffness", "damping")
        }
        return self.model_copy(update={**share, "feedback": 1.0})

    @property
    def arm(self) -> SevenAxisArm:
        """The arm's kinematics, inertias and limits."""
        return PACKING_ARMS[self.model]

    @property
    def bent(self) -> tuple[Array, Array]:
        """Lower and upper limits `(7,)` [rad] within which the elbow stays bent to the side of the home pose.

        Beyond the straight arm the Panda's elbow has 0.4 rad to its limit. An arm that follows twists gets in
        there, and does not get out: at the straight arm no twist bends the elbow.
        """
        limits, straight = self.arm.limits, self.arm.straight
        lower, upper = limits.lower.copy(), limits.upper.copy()
        if self.home[ELBOW] < straight:
            upper[ELBOW] = min(upper[ELBOW], straight - BENT)
        else:
            lower[ELBOW] = max(lower[ELBOW], straight + BENT)
        return lower, upper

    @field_validator("model")
    @classmethod
    def _is_known(cls, model: str) -> str:
        if model not in PACKING_ARMS:
            raise ValueError(
                f"'{model}' is no arm; allowed: {', '.join(PACKING_ARMS)} (pack_core/robots/packing_arms.py)"
            )
        return model

    @model_validator(mode="after")
    def _starts_within_limits(self) -> ArmDrive:
        limits = self.arm.limits
        rows = zip(limits.names, self.home, limits.lower.tolist(), limits.upper.tolist(), strict=True)
        for name, position, lower, upper in rows:
            if not lower <= position <= upper:
                allowed = f"{lower:.3f} to {upper:.3f} rad for '{self.model}'"
                raise ValueError(f"home of {name} is {position}; allowed: {allowed}")
        return self


def add_motors(spec: mujoco.MjSpec, arm: SevenAxisArm) -> None:
    """A torque actuator on every joint, with the published limit; controls are torques `(7,)` [N m]."""
    for name, limit in zip(arm.joints, arm.limits.effort, strict=True):
        _add(spec, name, name, ctrllimited=True, ctrlrange=(-limit, limit)).set_to_motor()


def add_servos(spec: mujoco.MjSpec, drive: ArmDrive) -> None:
    """Add the driver's control law (Eq. 4) to the model, where the integrator treats its damping implicitly.

    Controls are desired positions and velocities `(14,)` [rad, rad/s]; the sum of both torques is
    limited as the driver limits it.
    """
    arm = drive.arm
    for i, name in enumerate(arm.joints):
        spec.joint(name).actfrclimited = True
        spec.joint(name).actfrcrange = (-arm.limits.effort[i], arm.limits.effort[i])
        _add(spec, f"{name}_position", name).set_to_position(kp=drive.stiffness[i])
    for i, name in enumerate(arm.joints):
        _add(spec, f"{name}_velocity", name).set_to_velocity(kv=drive.damping[i])


def make_heavy(spec: mujoco.MjSpec, arm: SevenAxisArm) -> None:
    """Make the joints too heavy for contacts to move, for a caller that sets their motion itself."""
    for name in arm.joints:
        spec.joint(name).armature = GUIDED_ARMATURE


def _add(spec: mujoco.MjSpec, name: str, joint: str, **settings: object) -> mujoco.MjsActuator:
    return spec.add_actuator(name=name, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT, **settings)
