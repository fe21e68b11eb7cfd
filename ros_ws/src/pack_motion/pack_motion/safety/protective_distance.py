"""The protective separation distance of speed and separation monitoring, in the standard's symbols.

ISO/TS 15066:2016, 5.5.4.2.3, since 2025 part of ISO 10218-2, states that a robot in motion keeps from a
person at least

    S_p = S_h + S_r + S_s + C + Z_d + Z_r.

S_h is the way of the person until the robot stands, S_r the way of the robot while it reacts, S_s its way
while it stops. See also Marvel and Norcross, "Implementing speed and separation monitoring in collaborative
robot workcells", Robotics and Computer-Integrated Manufacturing 44, 2017.

This computes the distance of the standard in a simulation. It makes no rated safety function: that needs a
sensor, a controller and brakes of a stated performance level.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array


class ProtectiveSeparation(Config):
    """The terms of the distance that do not depend on the robot's motion."""

    person_speed: PositiveFloat = Field(
        description="v_h of whoever is seen to be slower, or stands [m/s]; 1.6 in ISO 13855"
    )
    top_speed: PositiveFloat = Field(description="v_h of whoever is seen to be faster [m/s]")
    reaction: PositiveFloat = Field(
        description="part of T_r: a cycle, and what driver and joints are behind it; the age of the newest "
        "observation at the time of the setpoint is added [s]"
    )
    intrusion: NonNegativeFloat = Field(description="C, what reaches beyond what the sensor sees [m]")
    seen_uncertainty: NonNegativeFloat = Field(description="Z_d, of the position of whoever is seen [m]")
    robot_uncertainty: NonNegativeFloat = Field(description="Z_r, of the position of the robot [m]")
    reserve: NonNegativeFloat = Field(
        description="kept beyond S_p, for the noise of the next observation's place [m]"
    )
    speed_reserve: NonNegativeFloat = Field(
        description="by which everybody may be seen to be faster next time, for the noise of speeds [m/s]"
    )
    oldest: PositiveFloat = Field(
        description="age of an observation, at the time of the setpoint, when the next one comes: the arm "
        "gets faster only as far as the distance is kept until then [s]"
    )
    blind: PositiveFloat = Field(
        description="age of the newest observation at which the arm stops, as if the sensor were dead [s]"
    )


@dataclass(frozen=True)
class PredictedStop:
    """How the k bodies of the robot come to rest if the stop is triggered now.

    Attributes:
        stopping_time: T_s, from when it brakes until it stands [s].
        reaction_ways: the way of each body's fastest point until then `(k,)` [m], from where the gaps are
            measured: where the robot will be when it has caught up with what was asked of it.
        stopping_ways: the same within T_s `(k,)` [m].
    """

    stopping_time: float
    reaction_ways: Array
    stopping_ways: Array


def protective_distances(
    config: ProtectiveSeparation, speeds: Array, age: float, stop: PredictedStop
) -> Array:
    """S_p of k bodies of the robot from m people `(k, m)` [m].

    Nobody is taken to be slower than a person who walks. The robot's ways count in whatever direction they
    go: the sum is never less than the standard's, which counts what brings the robot nearer.

    Args:
        config: the terms that do not depend on the robot's motion.
        speeds: measured speed of each person `(m,)` [m/s].
        age: time since they were measured [s].
        stop: how the robot comes to rest.
    """
    v_h = np.clip(speeds, config.person_speed, config.top_speed)
    T_r = age + config.reaction
    S_h = v_h * (T_r + stop.stopping_time)
    ways = (stop.reaction_ways + stop.stopping_ways)[:, None]  # S_r + S_s
    return np.asarray(S_h + ways + config.intrusion + config.seen_uncertainty + config.robot_uncertainty)
