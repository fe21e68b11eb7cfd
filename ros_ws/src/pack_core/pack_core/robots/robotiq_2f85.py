"""Robotiq 2F-85 two-finger gripper, as an MjSpec subtree built from primitives.

The fingers' tips are wedges, thin at the tip and thicker above it: that decides how much room a grasp
needs beside a block. Their thickness was read off the manufacturer's drawing of the finger, 5.7 mm at
the tip and about half a millimetre more a millimetre above it. The linkage carries the fingers
parallel on an arc of 57 mm; here they run on straight guides, which leaves out that the tips sink by
1.7 mm while they close the last 8 mm on a block.
"""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from pack_core.rotations import Pose

FINGERS = ("finger_left", "finger_right")
"""Bodies of the fingers."""
FINGER_JOINTS = ("finger_left_joint", "finger_right_joint")
PADS = ("finger_left_pad", "finger_right_pad")
"""Geoms of the rubber pads."""
TIPS = ("finger_left_tip", "finger_right_tip")
"""Geoms of the metal tips behind the pads, whose sides push blocks."""
STROKE = 0.0425
"""Travel of each finger from closed to open [m]; the opening is twice that."""
MAX_FORCE = 235.0
"""Largest force between the fingers [N]."""
MAX_SPEED = 0.150
"""Fastest change of the opening [m/s]."""
LENGTH = 0.170
"""Flange to finger tips, with the coupling, at the opening of a 50 mm grasp [m]."""
X_FT = Pose(np.array([0.0, 0.0, LENGTH]))
"""Tool frame T on the flange: origin between the finger tips, z out of the gripper, fingers at +-x."""

TIP_WIDTH, PAD_WIDTH = 0.027, 0.022
"""Widths of finger tip and rubber pad across the closing axis [m]."""
TIP_THICKNESS, SLOPE = 0.0057, 0.52
"""Thickness along the closing axis at the tip [m], and its increase per metre above the tip."""
WEDGE_HEIGHT, PAD_HEIGHT, PAD_THICKNESS = 0.032, 0.0375, 0.002
"""Height over which a finger grows thicker, and height and thickness of the pad on it [m]."""
BODY_MASS, FINGER_MASS = 0.725, 0.1
"""Of the body, and of each of two fingers [kg]."""
DRIVE_INERTIA = 1.0
"""Inertia of the motor behind its gear, seen at a finger [kg]."""

DARK, GREY, RUBBER = (0.13, 0.13, 0.14, 1.0), (0.62, 0.63, 0.65, 1.0), (0.08, 0.08, 0.08, 1.0)
"""Colours of body, fingers and pads, RGBA."""
BOX = mujoco.mjtGeom.mjGEOM_BOX


def thickness_at(height: float) -> float:
    """How thick a finger is along the closing axis, `height` [m] above its tip [m]."""
    return TIP_THICKNESS + SLOPE * min(height, WEDGE_HEIGHT)


def add_robotiq_2f85(
    flange: mujoco.MjsBody, spec: mujoco.MjSpec, *, pad_friction: float, contype: int, conaffinity: int
) -> mujoco.MjsBody:
    """Hang the gripper on a flange.

    Returns:
        The body `gripper`; body `tool` is frame T. Joints `FINGER_JOINTS` are each finger's distance
        from the closing plane [m]; actuators of the same names take that distance and push with a force
        that the caller limits by their `forcerange`.
    """
    gripper = flange.add_body(name="gripper")
    gripper.mass, gripper.ipos, gripper.inertia = BODY_MASS, (0, 0, 0.055), (1.4e-3, 1.4e-3, 0.9e-3)
    gripper.explicitinertial = True
    collide = dict(contype=contype, conaffinity=conaffinity, mass=0)
    gripper.add_geom(name="coupling", type=mujoco.mjtGeom.mjGEOM_CYLINDER, fromto=(0, 0, 0, 0, 0, 0.014),
                     size=(0.0375, 0, 0), rgba=GREY, **collide)  # fmt: skip
    gripper.add_geom(name="palm", type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=(0, 0, 0.045, 0, 0, 0.075),
                     size=(0.0375, 0, 0), rgba=DARK, **collide)  # fmt: skip
    gripper.add_body(name="tool", pos=X_FT.p, quat=X_FT.q)
    _add_wedge_mesh(spec)
    for name, side in zip(FINGER_JOINTS, (-1.0, 1.0), strict=True):
        _add_finger(gripper, name, side, pad_friction, collide)
    _couple(spec)
    return gripper


def _add_finger(
    gripper: mujoco.MjsBody, joint: str, side: float, friction: float, collide: Mapping[str, object]
) -> None:
    """A finger: its frame is at the tip on the closing plane, x outwards."""
    quat = (1.0, 0.0, 0.0, 0.0) if side > 0 else (0.0, 0.0, 0.0, 1.0)
    finger = gripper.add_body(name=joint.removesuffix("_joint"), pos=X_FT.p, quat=quat)
    finger.mass, finger.ipos, finger.inertia = FINGER_MASS, (0.01, 0, -0.03), (5e-5, 5e-5, 2e-5)
    finger.explicitinertial = True
    finger.add_joint(
        name=joint, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(1, 0, 0), range=(0.0, STROKE), limited=True,
        armature=DRIVE_INERTIA, damping=20.0,
    )  # fmt: skip
    finger.add_geom(
        name=f"{finger.name}_pad", type=BOX, pos=(PAD_THICKNESS / 2, 0, -PAD_HEIGHT / 2),
        size=(PAD_THICKNESS / 2, PAD_WIDTH / 2, PAD_HEIGHT / 2), rgba=RUBBER,
        friction=(friction, 0.01, 0.001), condim=6, **collide,
    )  # fmt: skip
    finger.add_geom(
        name=f"{finger.name}_tip", type=mujoco.mjtGeom.mjGEOM_MESH, meshname="finger_wedge", rgba=GREY,
        friction=(friction, 0.01, 0.001), condim=6, **collide,
    )  # fmt: skip
    thick = thickness_at(WEDGE_HEIGHT)
    finger.add_geom(
        name=f"{finger.name}_shank", type=BOX, pos=(thick / 2 + 0.002, 0, -0.054),
        size=(thick / 2, TIP_WIDTH / 2, 0.022), rgba=DARK, **collide,
    )  # fmt: skip


def _add_wedge_mesh(spec: mujoco.MjSpec) -> None:
    """The tip from its lower end up: inner face behind the pad, outer face sloping, 27 mm wide."""
    inner, top = 0.5 * PAD_THICKNESS, -WEDGE_HEIGHT
    corners = [(inner, 0.0), (TIP_THICKNESS, 0.0), (thickness_at(WEDGE_HEIGHT), top), (inner, top)]
    half = TIP_WIDTH / 2
    vertices = [(x, y, z) for x, z in corners for y in (-half, half)]
    spec.add_mesh(name="finger_wedge", uservert=np.array(vertices).ravel())


def _couple(spec: mujoco.MjSpec) -> None:
    """Couple the fingers, which one motor moves by equal distances, and give each a position servo."""
    equality = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT, name1=FINGER_JOINTS[0], name2=FINGER_JOINTS[1],
        solref=(0.004, 1.0), solimp=(0.95, 0.99, 0.001, 0.5, 2.0),
    )  # fmt: skip
    # Coefficients of a quartic: the first joint's position is 0 + 1 times the second's.
    equality.data[:5] = (0.0, 1.0, 0.0, 0.0, 0.0)
    for name in FINGER_JOINTS:
        actuator = spec.add_actuator(
            name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, forcelimited=True,
            forcerange=(-MAX_FORCE, MAX_FORCE),
        )  # fmt: skip
        actuator.set_to_position(kp=20000.0, kv=400.0)
