"""KUKA LBR iiwa 14 R820.

Kinematics and joint ranges: KUKA, "LBR iiwa 7 R800, LBR iiwa 14 R820: Specification": 0.36 m from the
base to the shoulder, 0.42 m to the elbow, 0.40 m to the wrist and 0.126 m to the flange, payload 14 kg.
Speeds and torques: KUKA, "Sensitive robotics: LBR iiwa", table of axis data. Frames, masses, centres of
mass and inertias: the ROS model `iiwa_description` of ETH Zurich and kuka-isir, as Drake publishes it
(`iiwa14_no_collision.urdf`). Accelerations: Larsen, "Including a Collaborative Robot in Digital Twin
Manufacturing Systems", Chalmers 2019, Table 4. Rotor inertias are not published: those of the Panda are
taken. Capsules: drawn around the housings, whose diameter is about 0.14 m.
"""

from __future__ import annotations

import numpy as np

from pack_core.robots.joint_properties import JointLimits
from pack_core.robots.seven_axis_arm import QUARTER_X, UNROTATED, ArmLink, SevenAxisArm

_S = 0.7071067811865476
"""Sine and cosine of half a right angle."""
QUARTER_X_HALF_Z = (0.0, 0.0, _S, _S)
"""Half a turn about z after a quarter turn about x, as a quaternion wxyz."""
_RANGE = np.deg2rad([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0])
"""Of the joints to both sides of zero [rad]."""

IIWA14 = SevenAxisArm(
    name="iiwa14",
    limits=JointLimits(
        names=tuple(f"iiwa_joint_{i}" for i in range(1, 8)),
        lower=-_RANGE,
        upper=_RANGE,
        velocity=np.deg2rad([85.0, 85.0, 100.0, 75.0, 130.0, 135.0, 135.0]),
        acceleration=np.array([8.57, 8.57, 8.74, 11.36, 12.23, 15.72, 15.72]),
        effort=np.array([320.0, 320.0, 176.0, 176.0, 110.0, 40.0, 40.0]),
    ),
    links=(
        ArmLink((0, 0, 0.1575), UNROTATED, 5.76, (0, -0.03, 0.12), (0.033, 0.0333, 0.0123, 0, 0, 0),
                ((0.07, (0, 0, 0.04, 0, 0, 0.14)),), 0.075),
        ArmLink((0, 0, 0.2025), QUARTER_X_HALF_Z, 6.35, (0.0003, 0.059, 0.042),
                (0.0305, 0.0304, 0.011, 0, 0, 0),
                ((0.07, (0, 0, -0.05, 0, 0, 0.05)), (0.065, (0, 0.04, 0, 0, 0.15, 0))), 0.073,
                is_accented=True),
        ArmLink((0, 0.2045, 0), QUARTER_X_HALF_Z, 3.5, (0, 0.03, 0.13), (0.025, 0.0238, 0.0076, 0, 0, 0),
                ((0.065, (0, 0, 0.02, 0, 0, 0.16)),), 0.07),
        ArmLink((0, 0, 0.2155), QUARTER_X, 3.5, (0, 0.067, 0.034), (0.017, 0.0164, 0.006, 0, 0, 0),
                ((0.065, (0, 0, -0.05, 0, 0, 0.05)), (0.06, (0, 0.03, 0, 0, 0.13, 0))), 0.068,
                is_accented=True),
        ArmLink((0, 0.1845, 0), QUARTER_X_HALF_Z, 3.5, (0.0001, 0.021, 0.076),
                (0.01, 0.0087, 0.00449, 0, 0, 0),
                ((0.06, (0, 0, 0.02, 0, 0, 0.09)), (0.04, (0, 0.05, 0.12, 0, 0.05, 0.18))), 0.065),
        ArmLink((0, 0, 0.2155), QUARTER_X, 1.8, (0, 0.0006, 0.0004), (0.0049, 0.0047, 0.0036, 0, 0, 0),
                ((0.055, (0, 0, -0.03, 0, 0, 0.04)),), 0.058),
        ArmLink((0, 0.081, 0), QUARTER_X_HALF_Z, 1.2, (0, 0, 0.02), (0.001, 0.001, 0.001, 0, 0, 0),
                ((0.045, (0, 0, -0.02, 0, 0, 0.0)),), 0.05),
    ),
    base=((0.075, (-0.05, 0, 0.06, 0, 0, 0.06)), (0.075, (0, 0, 0.06, 0, 0, 0.11))),
    flange=0.045,
    payload=14.0,
    reach=(0.42, 0.72),
    joint_damping=0.5,
    armature=0.1,
    shell=(0.80, 0.81, 0.82, 1.0),
    dark=(0.30, 0.31, 0.33, 1.0),
    accent=(1.00, 0.42, 0.04, 1.0),
)  # fmt: skip
