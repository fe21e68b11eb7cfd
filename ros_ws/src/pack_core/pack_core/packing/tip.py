"""The compliant cup: three slide and three hinge joints at the middle of the held object's top."""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from pack_core.errors import ConfigError
from pack_core.packing.cell import Tip
from pack_core.rotations import Array, Pose, conjugate, multiply, rotate

SLIDES = ("tip_x", "tip_y", "tip_z")
HINGES = ("tip_roll", "tip_pitch", "tip_yaw")
TIP_JOINTS = (*SLIDES, *HINGES)
"""The joints in their order, in the held object's axes: it shifts first, then turns about x, y and z."""


def add_tip(body: mujoco.MjsBody, tip: Tip | None, p_NP: Array) -> None:
    """Hang a held object on the springs of the cup.

    Args:
        body: the held object.
        tip: stiffness and damping of the springs.
        p_NP: the cup's point P `(3,)` in the body's frame [m].

    Raises:
        ConfigError: the cup has no springs.
    """
    if tip is None:
        raise ConfigError("a compliant grip needs stiffnesses; give `tip` in config/cells/packing.yaml")
    kinds = [mujoco.mjtJoint.mjJNT_SLIDE] * 3 + [mujoco.mjtJoint.mjJNT_HINGE] * 3
    stiffness = [tip.lateral, tip.lateral, tip.axial, tip.bending, tip.bending, tip.twist]
    for i, name in enumerate(TIP_JOINTS):
        body.add_joint(
            name=name, type=kinds[i], axis=np.eye(3)[i % 3], pos=p_NP, stiffness=stiffness[i],
            damping=tip.damping_time * stiffness[i],
        )  # fmt: skip


def tip_coordinates(X_TN0: Pose, X_TN: Pose, p_NP: Array) -> Array:
    """Coordinates `(6,)` [m, rad] of the tip's joints that bring the held object from X_TN0 to X_TN.

    The joints are at the cup's point P, `p_NP` `(3,)` [m] in the object's frame.
    """
    inverse = conjugate(X_TN0.q)
    shift = rotate(inverse, X_TN.apply(p_NP) - X_TN0.apply(p_NP))
    # intrinsic angles "XYZ", since the hinges turn about x, y and z one after the other
    turn = Rotation.from_quat(multiply(inverse, X_TN.q), scalar_first=True).as_euler("XYZ")
    return np.concatenate([shift, turn])
