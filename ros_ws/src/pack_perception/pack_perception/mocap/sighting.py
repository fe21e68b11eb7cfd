"""Poses of objects from one frame: from their markers alone, or with an axis that physics predicts.

Two markers fix five of a body's six coordinates. The sixth, the rotation about the line through both,
follows from the direction of the body's z axis: up for a standing body, and as predicted for one that physics
carries. A direction is one more pair of vectors in Kabsch's problem, which then is Wahba's ("A Least Squares
Estimate of Satellite Attitude").

Let sigma be the standard deviation of a coordinate and S the sum of the markers' squared distances from their
centre, seen along the axis. Then the yaw has the standard deviation sigma / sqrt(S); for two markers at
distance b that is sigma * sqrt(2) / b. Of a tilt along their line the markers determine the share
S / (S + arm^2), of a tilt about that line nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.errors import MessageError
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, rotate
from pack_perception.mocap.rigid_body_fit import FitConfig, FitRefusal, Fits, Mask, align, fit_rigid_bodies

Z = np.array([0.0, 0.0, 1.0])
STANDING_ARM = 1.0
"""Arm of a standing body's axis, so long that markers hardly tilt it [m]."""
TOO_LITTLE = (FitRefusal.TOO_FEW, FitRefusal.COLLINEAR)
"""Refusals after which a fit with the expected axis is tried; mismatching markers are never used."""


class MarkerTable:
    """Marker frames as arrays: a row for each of a scene's n objects, a column for each of its m markers.

    Attributes:
        names: names of the objects, the new one last.
        p_BM: marker positions in the objects' frames `(n, m, 3)` [m].
    """

    def __init__(self, scene: Scene) -> None:
        self.names = [*scene.names, scene.new_object.name]
        self.p_BM = np.stack([scene.model_of(name).markers() for name in self.names])
        self._objects: tuple[str, ...] = ()
        self._rows = np.zeros(0, dtype=int)

    def sort(self, frame: MarkerFrame) -> tuple[Array, Mask]:
        """Measured positions p_WM `(n, m, 3)` [m], and which of them the frame has `(n, m)`.

        Raises:
            MessageError: the frame has an object or a marker that the scene does not have.
        """
        if frame.objects != self._objects:
            self._look_up(frame.objects)
        count = self.p_BM.shape[1]
        if frame.marker_index.min(initial=0) < 0 or frame.marker_index.max(initial=0) >= count:
            raise MessageError(f"frame with marker {frame.marker_index.max()}; objects have 0 to {count - 1}")
        p_WM, visible = np.zeros_like(self.p_BM), np.zeros(self.p_BM.shape[:2], dtype=bool)
        rows = self._rows[frame.object_index]
        p_WM[rows, frame.marker_index] = frame.p_WM
        visible[rows, frame.marker_index] = True
        return p_WM, visible

    def _look_up(self, objects: tuple[str, ...]) -> None:
        """Keep the rows of a frame's objects, which seldom change from one frame to the next."""
        if unknown := set(objects) - set(self.names):
            raise MessageError(f"frame with objects {sorted(unknown)}; the scene has {self.names}")
        self._objects = objects
        self._rows = np.array([self.names.index(name) for name in objects], dtype=int)


class AxisFitConfig(Config):
    """Conditions under which a fit with the axis is accepted."""

    min_markers: int = Field(default=2, ge=2, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.01, description="rms distance of the markers from their centre, seen along the axis [m]"
    )
    max_residual: PositiveFloat = Field(default=0.003, description="rms distance of a marker [m]")
    arm: PositiveFloat = Field(
        default=0.01,
        description="where up the axis a marker would tell its direction as well as physics predicts it [m]",
    )


def fit_with_axis(
    p_BM: Array, p_WM: Array, visible: Mask, expected: Array, is_known: Mask, config: AxisFitConfig
) -> Fits:
    """Fit poses to markers and to the directions in which the z axes are expected.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        expected: expected poses `(k, 7)`; their z axes are used.
        is_known: bodies `(k,)` whose expected pose comes from earlier fits. The others are taken to stand as
            expected, and are refused if their markers are not at the height that follows.
        config: conditions under which a fit is accepted.
    """
    arms, axes = np.where(is_known, config.arm, STANDING_ARM), rotate(expected[:, 3:], Z)
    # a unit vector scaled by the arm counts like a marker that far up the axis: arm^2 z_W z_B^T
    found = align(p_BM, p_WM, visible, (arms**2)[:, None, None] * axes[:, :, None] * Z)
    # how much higher the markers are than those of the expected pose
    lifts = p_WM[:, :, 2] - expected[:, None, 2] - rotate(expected[:, None, 3:], p_BM)[:, :, 2]
    refusals = tuple(
        FitRefusal.TOO_FEW if count < config.min_markers
        else FitRefusal.COLLINEAR if width < config.min_spread
        else FitRefusal.NOT_STANDING if not known and lift > config.max_residual
        else FitRefusal.RESIDUAL if miss > config.max_residual
        else None
        for count, width, known, lift, miss in zip(
            visible.sum(axis=1), _rms_from_centre(p_BM[:, :, :2], visible), is_known,
            _rms(lifts[:, :, None], visible), found.residual, strict=True,
        )
    )  # fmt: skip
    none = np.zeros(len(refusals), dtype=int)
    return Fits(found.p_WB, found.q_WB, found.residual, refusals, none)


def _rms(vectors: Array, visible: Mask) -> Array:
    """Root of the mean square length `(k,)` of the visible ones of `(k, m, d)`."""
    squares = (vectors**2).sum(axis=2) * visible
    return np.asarray(np.sqrt(squares.sum(axis=1) / np.maximum(visible.sum(axis=1), 1)))


def _rms_from_centre(points: Array, visible: Mask) -> Array:
    """Root of the mean square distance `(k,)` of the visible ones of `(k, m, d)` from their centre."""
    n = np.maximum(visible.sum(axis=1), 1)[:, None]
    centres = (points * visible[:, :, None]).sum(axis=1) / n
    return _rms(points - centres[:, None], visible)


@dataclass(frozen=True)
class MarkerSighting:
    """Measured poses of n objects; refused rows must not be used.

    Attributes:
        poses: X_WB as position and quaternion `(n, 7)`.
        is_partial: objects whose pose needed an expected axis beside its markers `(n,)`.
        refusals: why the markers gave no pose; None where they did.
        left_out: markers that were not used because they do not match the others `(n,)`.
    """

    poses: Array
    is_partial: Mask
    refusals: tuple[FitRefusal | None, ...]
    left_out: npt.NDArray[np.int_]

    @property
    def is_placed(self) -> Mask:
        """Objects that have a pose `(n,)`."""
        return np.array([refusal is None for refusal in self.refusals], dtype=bool)


def sight(
    p_BM: Array,
    p_WM: Array,
    visible: Mask,
    expected: Array,
    is_known: Mask,
    fit: FitConfig,
    axis: AxisFitConfig,
) -> MarkerSighting:
    """Fit every object freely, and with its expected axis where its markers are too few for that.

    Args:
        p_BM: where the m markers are on each of the n objects `(n, m, 3)` [m].
        p_WM: where they were measured `(n, m, 3)` [m].
        visible: which of them were measured `(n, m)`.
        expected: expected poses `(k, 7)` of the first k objects; the others are fitted freely or not at all.
        is_known: whether these come from earlier fits `(k,)`; the other objects are expected to stand.
        fit: conditions under which a free fit is accepted.
        axis: conditions under which a fit with the axis is accepted.
    """
    free = fit_rigid_bodies(p_BM, p_WM, visible, fit)
    poses, refusals = np.concatenate([free.p_WB, free.q_WB], axis=1), list(free.refusals)
    is_partial = np.zeros(len(poses), dtype=bool)
    rows = [i for i in range(len(expected)) if refusals[i] in TOO_LITTLE]
    if not rows:
        return MarkerSighting(poses, is_partial, tuple(refusals), free.left_out)
    led = fit_with_axis(p_BM[rows], p_WM[rows], visible[rows], expected[rows], is_known[rows], axis)
    poses[rows] = np.concatenate([led.p_WB, led.q_WB], axis=1)
    for i, refusal in zip(rows, led.refusals, strict=True):
        refusals[i], is_partial[i] = refusal, refusal is None
    return MarkerSighting(poses, is_partial, tuple(refusals), free.left_out)
