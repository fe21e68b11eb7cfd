"""Touching tables and pallet with a corner of the pad: where, with which pose of the tool, what is felt."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pack_core.joints import JointSample
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import POINTING_DOWN, Array, Pose, exp, from_yaw, multiply, rotate
from pack_core.tasks.steps import Steps
from pallet_calibration.rig import CalibrationFailed, CalibrationRig, TouchInterrupted

FAST, SLOW = 0.010, 0.001
"""Speeds at which a surface is first sought, and then touched [m/s]."""
BACK = 0.0025
"""How far before the surface that was found the slow approach begins [m]."""
FOUND, PRESS = 80.0, 250.0
"""Forces at which it counts as found, and up to which is then pressed [N]; the gripper bears 350 N along its
axis, and 250 N across."""
BASELINE = 0.4
"""Time at even speed before which nothing may be touched [s]."""
MOVING = 0.12
"""Joints that turn faster than this a metre of the tool count [rad/m]: else friction hides their load."""
SIGMA = 0.002 * LIMITS.effort
"""Noise of a measured torque `(6,)` [N m]; stated by the driver."""
TRIES = 3
"""How often a touch is tried that the driver interrupts, as it does when setpoints come late."""
SMOOTH = 8
"""Samples over which the felt force is averaged."""
TILT = np.deg2rad(4.0)
"""By which the tool is tilted over a level surface, so that one corner of the pad touches it first [rad]."""
CLEAR = 0.012
"""Distance from the nominal surface at which an approach begins [m]."""
TRAVEL = 0.03
"""Longest way of an approach [m]: from `CLEAR` over the nominal surface to 18 mm beyond it."""
DOWN = np.array([0.0, 0.0, -1.0])
DEEP = 0.014
"""Below the deck, where its edges are touched [m]: in the upper boards, which are 22 mm thick."""
AXES = ("along x", "along y", "from above")
"""How a surface is touched, by the coordinate that is felt."""


@dataclass(frozen=True)
class Touch:
    """What was recorded of a touch.

    Attributes:
        what: name of the surface.
        axis: which coordinate of the surface's own frame is felt: 0, 1 or 2.
        at: value of that coordinate where the surface nominally ends [m], in the nominal world.
        normal: direction of the approach in the world `(3,)`.
        p_TC: touching corner in the tool's frame `(3,)` [m].
        times: when the samples were taken `(n,)` [s].
        q: reported joint angles on the way `(n, 6)` [rad].
        tau: measured torques on the way `(n, 6)` [N m].
    """

    what: str
    axis: int
    at: float
    normal: Array
    p_TC: Array
    times: Array
    q: Array
    tau: Array


def touch(
    rig: CalibrationRig,
    X_WT: Pose,
    normal: Array,
    travel: float,
    surface: tuple[str, int, float],
    p_TC: Array,
) -> Steps[Touch]:
    """Approach a surface from a pose and press on it.

    Args:
        rig: the cell.
        X_WT: pose of the tool from which it approaches.
        normal: direction of the approach `(3,)`.
        travel: length after which there is certainly something [m].
        surface: its name, the axis that is felt, and its nominal coordinate [m].
        p_TC: the corner of the pad that touches `(3,)` [m].

    Raises:
        CalibrationFailed: nothing was felt, or the arm was held again and again.
    """
    reason = ""
    for _ in range(TRIES):
        try:
            return (yield from _touch_once(rig, X_WT, normal, travel, surface, p_TC))
        except TouchInterrupted as error:
            reason = str(error)
            yield from rig.line(X_WT, 0.1)
    raise CalibrationFailed(f"{surface[0]}: the touch was interrupted {TRIES} times: {reason}")


def _touch_once(
    rig: CalibrationRig,
    X_WT: Pose,
    normal: Array,
    travel: float,
    surface: tuple[str, int, float],
    p_TC: Array,
) -> Steps[Touch]:
    yield from rig.go(X_WT)
    yield from rig.pause(0.3)
    end = Pose(X_WT.p + travel * normal, X_WT.q)
    yield from rig.press(end, FAST, Feeler(rig, normal, p_TC, FAST, FOUND).feels)
    near = Pose(rig.tool().p - BACK * normal, X_WT.q)
    yield from rig.line(near, 0.02)
    yield from rig.pause(0.2)
    samples = yield from rig.press(end, SLOW, Feeler(rig, normal, p_TC, SLOW, PRESS).feels)
    yield from rig.line(X_WT, 0.1)
    times, q, tau = (np.array([getattr(s, name) for s in samples]) for name in ("time", "q", "tau"))
    return Touch(*surface, normal, p_TC, times, q, tau)


class Feeler:
    """Watches the torques during an approach.

    Args:
        rig: the cell, for its kinematics.
        normal: direction of the approach `(3,)`.
        p_TC: the corner that touches `(3,)` [m].
        speed: of the approach [m/s].
        enough: force at which it says so [N].
    """

    def __init__(self, rig: CalibrationRig, normal: Array, p_TC: Array, speed: float, enough: float) -> None:
        self._chain = rig.arm.chain.with_tool(Pose(p_TC))
        self._normal = normal
        self._skip = round(speed / 0.1 / rig.period) + 25  # the acceleration, and the servo's settling
        self._speed, self._enough = speed, enough
        self._length = round(BASELINE / rig.period)
        self._seen: list[JointSample] = []
        self._last: deque[float] = deque(maxlen=SMOOTH)

    def feels(self, sample: JointSample) -> bool:
        """Whether the force along the approach is that up to which is pressed."""
        self._seen.append(sample)
        if len(self._seen) <= self._skip + self._length:
            return False
        quiet = self._seen[self._skip : self._skip + self._length]
        resting = np.mean([s.tau for s in quiet], axis=0)
        rate = (quiet[-1].q - quiet[0].q) / (quiet[-1].time - quiet[0].time)
        J = self._chain.jacobian(sample.q)[:3]
        self._last.append(float(push_vector(J, sample.tau - resting, rate / self._speed) @ self._normal))
        return len(self._last) == SMOOTH and float(np.mean(self._last)) > self._enough


def push_vector(J: Array, change: Array, rate: Array) -> Array:
    """Force of the tool on what it touches `(3,)` [N], from the change of the torques `(6,)` [N m].

    Only joints that turn are used, at a rate `(6,)` [rad/m] along the approach; forces that they do not feel
    are taken for small.
    """
    moving = np.abs(rate) > MOVING
    A = (J[:, moving] / SIGMA[moving]).T  # tau = J^T f
    b = change[moving] / SIGMA[moving]
    ridge = np.eye(3) / 300.0**2
    return np.asarray(np.linalg.solve(A.T @ A + ridge, A.T @ b))


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
    return multiply(from_yaw(yaw), POINTING_DOWN)
