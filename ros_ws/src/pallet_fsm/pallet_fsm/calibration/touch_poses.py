"""Where tables and pallet are touched, and with which pose of the tool."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pack_core.camera import LOOKING_DOWN
from pack_core.rotations import Array, Pose, exp, from_yaw, multiply, rotate
from pallet_fsm.calibration.rig import CalibrationRig

TILT = np.deg2rad(4.0)
"""By which the tool is tilted over a level surface, so that one corner of the pad touches it first [rad]."""
CLEAR = 0.012
"""Distance from the nominal surface at which an approach begins [m]."""
TRAVEL = 0.03
DOWN = np.array([0.0, 0.0, -1.0])
DEEP = 0.014
"""Below the deck, where its edges are touched [m]: in the upper boards, which are 22 mm thick."""
AXES = ("along x", "along y", "from above")
"""How a surface is touched, by the coordinate that is felt."""


def touches(rig: CalibrationRig) -> Iterator[tuple[tuple[str, int, float], Pose, Array, Array]]:
    """Surface, pose from which it is approached, direction, and the pad's corner, one after the other."""
    cell, half = rig.known, 0.5 * rig.known.tool.model_dump()["pad_size"]
    for name, reach in (("picking_table", 0.32), ("reorientation_table", 0.28)):
        table = getattr(cell, name)
        for x, y in ((0.0, 0.0), (reach, reach), (-reach, reach), (-reach, -reach), (reach, -reach)):
            p = np.array([table.centre[0] + x, table.centre[1] + y, table.height])
            yield (name, 2, table.height), *from_above(rig, p, half)
    (x_0, y_0), (l, w), deck = cell.pallet.corner, cell.pallet.size, cell.pallet.deck_height
    for x, y in ((0.5, 0.5), (0.12, 0.15), (0.88, 0.15), (0.88, 0.85), (0.35, 0.85)):
        p = np.array([x_0 + x * l, y_0 + y * w, deck])
        yield ("pallet", 2, deck), *from_above(rig, p, half)
    # Where an edge is so near that the forearm would hang straight down, the wrist is singular.
    for share in (0.04, 0.2):
        p = np.array([x_0, y_0 + share * w, deck - DEEP])
        yield ("pallet", 0, x_0), *from_side(p, np.array([1.0, 0.0, 0.0]), half)
    for share in (0.4, 0.95):
        p = np.array([x_0 + share * l, y_0 + w, deck - DEEP])
        yield ("pallet", 1, y_0 + w), *from_side(p, np.array([0.0, -1.0, 0.0]), half)
    table = cell.reorientation_table
    edge = table.centre[1] - 0.5 * table.size[1]
    for share in (-0.35, 0.35):
        p = np.array([table.centre[0] + share * table.size[0], edge, table.height - DEEP])
        yield ("reorientation_table", 1, edge), *from_side(p, np.array([0.0, 1.0, 0.0]), half)
    edge = table.centre[0] - 0.5 * table.size[0]
    p = np.array([edge, table.centre[1] - 0.3 * table.size[1], table.height - DEEP])
    yield ("reorientation_table", 0, edge), *from_side(p, np.array([1.0, 0.0, 0.0]), half)


def from_above(rig: CalibrationRig, p_W: Array, half: float) -> tuple[Pose, Array, Array]:
    """A tool whose corner away from the arm is lowest, over a point `(3,)` [m]."""
    outward = p_W[:2] - rig.arm.chain.points[0][:2]
    level = rotated_down(float(np.arctan2(outward[1], outward[0])) + 0.25 * np.pi)
    p_TC = np.array([half, half, 0.0])
    reach = rotate(level, p_TC)
    q_WT = multiply(exp(TILT * np.cross(reach, DOWN) / np.linalg.norm(reach)), level)
    return Pose(p_W - CLEAR * DOWN - rotate(q_WT, p_TC), q_WT), DOWN, p_TC


def from_side(p_W: Array, normal: Array, half: float) -> tuple[Pose, Array, Array]:
    """A tool that points down, with a corner of the pad ahead, beside a point of an edge `(3,)` [m]."""
    heading = float(np.arctan2(normal[1], normal[0]))
    # Looking down, the tool's y axis is turned over: its corner (h, h, 0) lies at -45 degrees of its x axis.
    q_WT = rotated_down(heading + 0.25 * np.pi)
    p_TC = np.array([half, half, 0.0])
    return Pose(p_W - CLEAR * normal - rotate(q_WT, p_TC), q_WT), normal, p_TC


def rotated_down(yaw: float) -> Array:
    """Orientation wxyz of a tool that points down, its x axis at a yaw [rad]."""
    return multiply(from_yaw(yaw), LOOKING_DOWN)
