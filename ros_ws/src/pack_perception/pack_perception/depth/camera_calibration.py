"""Where depth cameras hang, from images of the arm's own pump at postures that the joints report.

The pump's shape is known, and where it is follows from the joints. A camera's pose is corrected until what it
measures of the pump lies on the pump's surface at all postures (the method of Gauss and Newton, points to
surface). Nothing else of the cell counts, so that the result holds whatever stands below the arm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.camera import PinholeCamera
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.packing.depth import points_of
from pack_core.rotations import Array, Pose, exp, rotate
from pack_perception.depth.registration import Registration
from pack_perception.depth.tool_shape import ToolShape


class CameraCalibrationFailed(PackError):
    """A camera's pose cannot be found, or is not to be trusted; the text says why."""


class CameraCalibrationConfig(Config):
    """How a camera's pose is found, and when it is refused."""

    reaches: tuple[PositiveFloat, ...] = Field(
        default=(0.04, 0.04, 0.03, 0.03, 0.02, 0.015, 0.01, 0.008, 0.006, 0.006, 0.006, 0.006),
        min_length=1,
        description="farthest that a point is from the pump, by step of a fit [m]",
    )
    scale: PositiveFloat = Field(default=0.0015, description="deviation from which a point counts less [m]")
    edge: PositiveFloat = Field(
        default=0.01,
        description="step of depth between neighbours at which a pixel is an edge and left out [m]",
    )
    few: PositiveInt = Field(default=150, description="fewer points on the pump make no view of it")
    postures: PositiveInt = Field(default=12, description="fewest postures at which a camera sees the pump")
    every: PositiveInt = Field(default=2, description="every many pixels of a row or column one is used")
    residual: PositiveFloat = Field(
        default=0.0003,
        description="most that the pump is seen from where the joints have it, root mean square [m]",
    )
    sigma: PositiveFloat = Field(
        default=0.0005, description="largest standard deviation of a result at the container [m]"
    )
    shift: PositiveFloat = Field(
        default=0.03,
        description="farthest that a camera may be from its described place, at the container [m]",
    )
    turn_deg: PositiveFloat = Field(default=3.0, description="most that it may be turned [deg]")


@dataclass(frozen=True)
class ArmView:
    """What the cameras measured while the arm stood still.

    Attributes:
        q: joint positions `(n,)` [rad].
        images: depth along the optical axes `(frames, cameras, height, width)` [m]; 0: nothing was measured.
    """

    q: Array
    images: Array


@dataclass(frozen=True)
class LocatedCamera:
    """Where a camera hangs.

    Attributes:
        camera: the camera there.
        off: how far that is from where it is described.
        covariance: of `off`, shift and turn `(6, 6)` [m, rad].
        places: how far the pump is seen from where the joints have it, by posture `(k, 3)` [m].
    """

    camera: PinholeCamera
    off: Registration
    covariance: Array
    places: Array

    @property
    def residual(self) -> float:
        """Root mean square of the distances of the pump from where the joints have it [m]."""
        return float(np.sqrt(np.mean(np.sum(self.places**2, axis=1))))

    @property
    def sigma_shift(self) -> float:
        """Standard deviation of the shift at the container, along its worst axis [m]."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[:3, :3])[-1]))

    @property
    def sigma_turn(self) -> float:
        """Standard deviation of the turn, about its worst axis [rad]."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[3:, 3:])[-1]))


@dataclass(frozen=True)
class ToolPoints:
    """What a camera measured near the tool at one posture: points `(n, 3)` [m], by its described pose."""

    X_WT: Pose
    points: Array


@dataclass(frozen=True)
class _Matches:
    """Points on the tool: distances `(n,)` [m], rows of the Jacobian `(n, 6)`, weights `(n,)`."""

    d: Array
    J: Array
    w: Array


def find_camera(
    camera: PinholeCamera, number: int, views: Sequence[ArmView], tool: ToolShape, middle: Array,
    config: CameraCalibrationConfig,
) -> LocatedCamera:  # fmt: skip
    """Where a camera hangs.

    Args:
        camera: the camera as described.
        number: its place among the cameras of the images.
        views: what was seen.
        tool: the arm and the shape of its tool.
        middle: the point of the container about which turns count `(3,)` [m].
        config: parameters.

    Raises:
        CameraCalibrationFailed: too little was seen, or what was seen does not agree.
    """
    seen = [_near_tool(camera, number, view, tool, config) for view in views]
    seen = [part for part in seen if len(part.points) >= config.few]
    if len(seen) < config.postures:
        raise CameraCalibrationFailed(
            f"it sees the pump at {len(seen)} postures of {len(views)}; needed: {config.postures}. Is its "
            "lens covered, does something stand in its way, or does it look elsewhere?"
        )
    x = np.zeros(6)
    for reach in config.reaches:
        matches = [_match(part, x, tool, middle, reach, config) for part in seen]
        # a weak prior: what the postures leave open stays as described
        H = _information(matches) + np.diag([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
        x = x - np.linalg.solve(H, sum(m.J.T @ (m.w * m.d) for m in matches))
    matches = [_match(part, x, tool, middle, config.reaches[-1], config) for part in seen]
    off = Registration(middle, x[:3], x[3:])
    places = np.array([_place(m) for m in matches])
    return LocatedCamera(off.applied_to(camera), off, _covariance(matches), places)


def doubts(found: LocatedCamera, config: CameraCalibrationConfig) -> list[str]:
    """Why a result should not be used, in words; empty when nothing speaks against it."""
    reasons = []
    if found.residual > config.residual:
        far = 1e3 * float(np.linalg.norm(found.places, axis=1).max())
        reasons.append(
            f"the pump is seen {1e3 * found.residual:.2f} mm (rms) from where the joints have it, and "
            f"{far:.1f} mm at one posture; allowed: {1e3 * config.residual:.2f} mm. "
            "Was the camera knocked meanwhile, or does the pump differ from `pump` in "
            "config/cells/packing.yaml?"
        )
    if found.sigma_shift > config.sigma:
        reasons.append(
            f"its place is known to {1e3 * found.sigma_shift:.2f} mm; allowed: {1e3 * config.sigma:.2f} mm. "
            "Postures that differ more tell more"
        )
    shift, turn = np.linalg.norm(found.off.shift), np.rad2deg(np.linalg.norm(found.off.turn))
    if shift > config.shift or turn > config.turn_deg:
        reasons.append(
            f"it is off by {found.off.in_words()}; allowed: {1e3 * config.shift:.0f} mm and "
            f"{config.turn_deg:.1f} degrees. Describe its place in config/cells/packing.yaml more nearly"
        )
    return reasons


def _near_tool(
    camera: PinholeCamera, number: int, view: ArmView, tool: ToolShape, config: CameraCalibrationConfig
) -> ToolPoints:
    """The points of a view near the tool, without those at edges of depth."""
    X_WT = tool.chain.forward(view.q)
    images = [_without_edges(frame[number], config.edge) for frame in view.images]
    points = np.concatenate([points_of(camera, image, config.every) for image in images])
    distances, _ = tool.distances(X_WT.inverse().apply(points))
    return ToolPoints(X_WT, points[distances < config.reaches[0]])


def _without_edges(image: Array, step: float) -> Array:
    """The image with 0 wherever depth jumps between neighbours: pixels fly there."""
    kernel = np.ones((3, 3), np.uint8)
    known = image > 0.0
    near = cv2.erode(np.where(known, image, np.inf), kernel)
    far = cv2.dilate(np.where(known, image, 0.0), kernel)
    return np.where(known & (far - near < step), image, 0.0)


def _match(
    part: ToolPoints, x: Array, tool: ToolShape, middle: Array, reach: float, config: CameraCalibrationConfig
) -> _Matches:
    """The points of a posture that lie within `reach` [m] of the tool with the camera moved by `x` `(6,)`."""
    r = part.points - middle
    moved = middle + x[:3] + rotate(exp(x[3:]), r)
    p_T = part.X_WT.inverse().apply(moved)
    d, normals_T = tool.distances(p_T)
    # the arm goes on behind the flange
    on = (np.abs(d) < reach) & (p_T[:, 2] > tool.flange + reach)
    n = rotate(part.X_WT.q, normals_T[on])
    w = 1.0 / (1.0 + (d[on] / config.scale) ** 2)
    return _Matches(d[on], np.concatenate([n, np.cross(moved[on] - middle - x[:3], n)], axis=1), w)


def _information(matches: Sequence[_Matches]) -> Array:
    return np.asarray(sum((m.J * m.w[:, None]).T @ m.J for m in matches))


OPEN = 0.02
"""Share of the points' weight by which what a posture leaves open counts as seen in its place."""


def _place(m: _Matches) -> Array:
    """How far the tool is seen from where the joints have it `(3,)` [m]."""
    n = m.J[:, :3]
    H = (n * m.w[:, None]).T @ n + OPEN * m.w.sum() * np.eye(3)
    return np.asarray(np.linalg.solve(H, -(n * m.w[:, None]).T @ m.d))


ALIKE = 1.6
"""By which errors exceed what postures that have nothing in common would tell: the same pixels see the pump
at several of them, and a part of their errors stays. Measured with 32 cameras under `installed`."""


def _covariance(matches: Sequence[_Matches]) -> Array:
    """Covariance of shift and turn `(6, 6)`.

    Errors of one posture are alike, those of two are so in part: the sandwich estimate with a cluster for
    each posture (Liang and Zeger 1986, "Longitudinal data analysis using generalized linear models"), times
    the square of `ALIKE`.
    """
    bread = np.linalg.pinv(_information(matches), hermitian=True)
    scores = np.array([m.J.T @ (m.w * m.d) for m in matches])
    k, p = scores.shape
    return np.asarray(ALIKE**2 * bread @ (scores.T @ scores) @ bread * k / max(k - p, 1))
