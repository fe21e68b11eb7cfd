"""The hand-over place: where the next object truly stands, and whether the cup seals on it."""

from __future__ import annotations

import numpy as np
import shapely
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene, name_fault
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Pose, angle_between, exp, from_yaw, multiply

SEAL_GAP = 0.003
"""Largest distance between the cup's lip and the object's top at which suction draws them together [m]."""
SEAL_TILT = np.deg2rad(5.0)
"""Largest angle between the cup's axis and the normal of the top: a bellows adapts to so much [rad]."""
HANG_DISTANCE, HANG_ANGLE = 0.005, np.deg2rad(2.0)
"""An object that was let go hangs again if it is at most this far from where it would [m] and [rad]."""
LIP = 0.9
"""Share of the cup's radius that must be on the top; the lip's outer tenth may stand over an edge."""


class HandOverConfig(Config):
    """Errors of where an object is handed over, uniformly distributed about what is announced."""

    position: NonNegativeFloat = Field(default=0.004, description="most along x and along y [m]")
    yaw_deg: NonNegativeFloat = Field(default=3.0, description="most that its heading is off [deg]")


def presented_pose(X_WN: Pose, config: HandOverConfig, rng: np.random.Generator) -> Pose:
    """Where an object announced at X_WN truly stands."""
    dx, dy, turn = rng.uniform(-1.0, 1.0, 3)
    shift = config.position * np.array([dx, dy, 0.0])
    return Pose(X_WN.p + shift, multiply(from_yaw(turn * np.deg2rad(config.yaw_deg)), X_WN.q))


def present_fault(item: ObjectModel, scene: Scene, *, is_held: bool, keep: bool) -> str:
    """Why an object cannot arrive in a scene; empty if it can.

    Args:
        item: the object.
        scene: what there is.
        is_held: whether the pump holds the scene's new object.
        keep: whether that stays in the container.
    """
    if item.pose is None:
        return f"'{item.name}' has no pose; allowed: where it is handed over"
    if is_held:
        return f"the pump holds '{scene.new_object.name}'; pack or release it first"
    if item.name in scene.names or (keep and item.name == scene.new_object.name):
        return f"'{item.name}' is in the container already; allowed: another name"
    return name_fault([item.name])


def seal_fault(X_TN: Pose, item: SceneItem, cup_radius: float) -> str:
    """Why a cup T does not seal on the top of an object N at X_TN; empty if it does."""
    X_NT = X_TN.inverse()
    gap = float(X_NT.p[2] - item.half_extents[2])
    if abs(gap) > SEAL_GAP:
        return f"the cup is {1e3 * gap:.1f} mm over the object's top; allowed: {1e3 * SEAL_GAP:.0f} mm"
    upright = multiply(X_NT.q, exp([np.pi, 0.0, 0.0]))
    # the heading does not matter: what is left of the rotation without it is the tilt
    heading = np.array([upright[0], 0.0, 0.0, upright[3]])
    tilt = float(angle_between(heading / np.linalg.norm(heading), upright))
    if tilt > SEAL_TILT:
        return f"the cup is tilted by {np.rad2deg(tilt):.1f} degrees; allowed: {np.rad2deg(SEAL_TILT):.0f}"
    lip = shapely.Point(X_NT.p[:2]).buffer(LIP * cup_radius)
    if not shapely.MultiPoint(item.top_face()).convex_hull.covers(lip):
        x, y = 1e3 * X_NT.p[:2]
        return f"the lip is not on the object's top, its middle at x {x:.0f}, y {y:.0f} mm of it"
    return ""


def hang_fault(X_TN: Pose, nominal: Pose) -> str:
    """Why an object N at X_TN cannot hang from a cup T as described, at `nominal`; empty if it can."""
    distance, angle = float(np.linalg.norm(X_TN.p - nominal.p)), float(angle_between(X_TN.q, nominal.q))
    if distance > HANG_DISTANCE or angle > HANG_ANGLE:
        return (
            f"the object is {1e3 * distance:.0f} mm and {np.rad2deg(angle):.0f} degrees off the cup; "
            f"allowed: {1e3 * HANG_DISTANCE:.0f} mm and {np.rad2deg(HANG_ANGLE):.0f} degrees"
        )
    return ""
