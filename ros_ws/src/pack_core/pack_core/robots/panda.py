"""Franka Emika Panda.

Kinematics and limits: the manufacturer's modified DH table and data sheet. Inertias: Gaz, Cognetti,
Oliva, Robuffo Giordano, De Luca, "Dynamic identification of the Franka Emika Panda robot with retrieval
of feasible parameters using penalty-based optimization", IEEE RA-L 4(4), 2019. Capsules: the
manufacturer's coarse collision model.
"""

from __future__ import annotations

import numpy as np

from pack_core.robots.joint_properties import JointLimits
from pack_core.robots.seven_axis_arm import MINUS_QUARTER_X, QUARTER_X, UNROTATED, ArmLink, SevenAxisArm

PANDA = SevenAxisArm(
    name="panda",
    limits=JointLimits(
        names=tuple(f"panda_joint{i}" for i in range(1, 8)),
        lower=np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]),
        upper=np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]),
        velocity=np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]),
        acceleration=np.array([15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0]),
        effort=np.array([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]),
    ),
    links=(
        ArmLink((0, 0, 0.333), UNROTATED, 4.970684, (0.003875, 0.002081, -0.04762),
                (0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169),
                ((0.06, (0, 0, -0.333, 0, 0, -0.05)),), 0.065),
        ArmLink((0, 0, 0), MINUS_QUARTER_X, 0.646926, (-0.003141, -0.02872, 0.003495),
                (0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704),
                ((0.06, (0, 0, -0.06, 0, 0, 0.06)),), 0.065, is_accented=True),
        ArmLink((0, -0.316, 0), QUARTER_X, 3.228604, (0.027518, 0.039252, -0.066502),
                (0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805),
                ((0.06, (0, 0, -0.22, 0, 0, -0.07)),), 0.065),
        ArmLink((0.0825, 0, 0), QUARTER_X, 3.587895, (-0.05317, 0.104419, 0.027454),
                (0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641),
                ((0.06, (0, 0, -0.06, 0, 0, 0.06)),), 0.065, is_accented=True),
        ArmLink((-0.0825, 0.384, 0), MINUS_QUARTER_X, 1.225946, (-0.011953, 0.041065, -0.038437),
                (0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229),
                ((0.06, (0, 0, -0.31, 0, 0, -0.21)), (0.03, (0, 0.08, -0.20, 0, 0.08, -0.06))), 0.065),
        ArmLink((0, 0, 0), QUARTER_X, 1.666555, (0.060149, -0.014117, -0.010517),
                (0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341),
                ((0.05, (0, 0, -0.07, 0, 0, 0.01)), (0.045, (0.03, 0, 0, 0.088, 0, 0))), 0.05),
        ArmLink((0.088, 0, 0), QUARTER_X, 0.735522, (0.010517, -0.004252, 0.061597),
                (0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741),
                ((0.045, (0, 0, -0.01, 0, 0, 0.065)),), 0.05),
    ),
    base=((0.06, (-0.09, 0, 0.06, -0.06, 0, 0.06)), (0.065, (0, 0, 0.05, 0, 0, 0.12))),
    flange=0.107,
    payload=3.0,
    reach=(0.2, 0.75),
    joint_damping=1.0,
    armature=0.1,
    shell=(0.93, 0.94, 0.95, 1.0),
    dark=(0.16, 0.17, 0.19, 1.0),
    accent=(0.10, 0.45, 0.78, 1.0),
)  # fmt: skip
