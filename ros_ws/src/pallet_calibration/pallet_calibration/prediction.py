"""How far off boxes will be that are placed with a calibration: its uncertainty, followed through the cell.

Cells are drawn from the covariance of the estimate. In each of them a box is seen, gripped and placed as the
state machine does it with the calibration, by kinematics alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.calibration import PlacingError
from pack_core.rotations import Array, Pose, from_yaw, yaw_of
from pallet_calibration.estimate import JOINTS, CalibrationFit
from pallet_calibration.model import CellModel
from pallet_calibration.parameters import (
    lens_of,
)
from pallet_calibration.touch import rotated_down

DRAWS = 400
"""Placings that are drawn: the 95th percentile is then decided by the worst 20."""
SEEN = 5e-5
"""Standard deviation of box vision, in each direction [m]: what blur and noise of the picture leave."""
SEEN_YAW = np.deg2rad(0.01)
"""The same of the yaw [rad]."""
LET_GO = 1e-4
"""Standard deviation of how far a box moves when it is let go 2 mm over its place, in each direction [m]."""


@dataclass(frozen=True)
class Handled:
    """A box on its way: where it is taken from and put, and its height [m]."""

    X_NB: Pose
    """On the table as it nominally stands."""
    X_PB: Pose
    height: float


def predict(model: CellModel, found: CalibrationFit, rng: np.random.Generator) -> PlacingError:
    """Mean and 95th percentile of the distance of placed boxes from their places."""
    roots = np.linalg.cholesky(found.covariance)
    errors = [
        _error(model, found.x, found.x + roots @ rng.standard_normal(len(found.x)), _box(model, rng), rng)
        for _ in range(DRAWS)
    ]
    off = 1e3 * np.array([error for error in errors if error is not None])
    return PlacingError(mean=float(off.mean()), p95=float(np.percentile(off, 95)))


def _box(model: CellModel, rng: np.random.Generator) -> Handled:
    cell, height = model.cell, float(rng.uniform(0.1, 0.4))
    offset = rng.uniform(-cell.spawn.offset, cell.spawn.offset, 2)
    p = np.array([*(cell.picking_table.middle[:2] + offset), cell.picking_table.height + 0.5 * height])
    yaw = np.deg2rad(rng.uniform(-cell.spawn.yaw_deg, cell.spawn.yaw_deg))
    place = rng.uniform(0.15, 0.85, 2) * np.array(cell.pallet.size)
    X_PB = Pose(np.array([*place, 0.5 * height + rng.uniform(0.0, 0.5)]))
    return Handled(Pose(p, from_yaw(yaw)), X_PB, height)


def _error(model: CellModel, x: Array, true: Array, box: Handled, rng: np.random.Generator) -> float | None:
    """How far from its place a box is put by what `x` says in a `true` cell [m]; None if out of reach."""
    believed, real = model.known(x), model.known(true)
    X_WB_real = real.picking_table.displaced(box.X_NB)
    X_WB = _seen(model, x, true, box, rng)
    up = np.array([0.0, 0.0, 0.5 * box.height])
    grip = Pose(X_WB.p + up, rotated_down(yaw_of(X_WB.q)))
    at_grip = _true_tool(model, grip, x, true, rng)
    if at_grip is None:
        return None
    goal = believed.pallet.X_WP @ box.X_PB
    release = goal @ (grip.inverse() @ X_WB).inverse()
    at_release = _true_tool(model, release, x, true, rng)
    if at_release is None:
        return None
    placed = at_release @ (at_grip.inverse() @ X_WB_real)
    off = (real.pallet.X_WP.inverse() @ placed).p[:2] - box.X_PB.p[:2]  # its height is that of the deck
    return float(np.linalg.norm(off + LET_GO * rng.standard_normal(2)))


def _seen(model: CellModel, x: Array, true: Array, box: Handled, rng: np.random.Generator) -> Pose:
    """The pose that box vision finds: pixels of the true cell, read with the believed camera and table."""
    believed, real = model.known(x), model.known(true)
    half = np.array([0.0, 0.0, 0.5 * box.height])
    along = np.array([0.15, 0.0, 0.0])
    points = real.picking_table.displaced(box.X_NB).apply(np.array([half, half + along]))
    camera, known = real.overhead_camera, believed.overhead_camera
    p_C = camera.X_WC.inverse().apply(points)
    lens = lens_of(true).coefficients
    pixels, _ = cv2.projectPoints(p_C, np.zeros(3), np.zeros(3), camera.K, lens)
    flat = cv2.undistortPoints(pixels, known.K, lens_of(x).coefficients, None, None, known.K).reshape(-1, 2)
    table = believed.picking_table
    X_NW = table.displacement.about(table.middle).inverse()
    found = replace(known, X_WC=X_NW @ known.X_WC).at_height(flat, table.height + box.height)
    yaw = float(np.arctan2(*(found[1] - found[0])[1::-1])) + SEEN_YAW * rng.standard_normal()
    p = np.array([*(found[0, :2] + SEEN * rng.standard_normal(2)), table.height + 0.5 * box.height])
    return table.displaced(Pose(p, from_yaw(yaw)))


def _true_tool(model: CellModel, X_WT: Pose, x: Array, true: Array, rng: np.random.Generator) -> Pose | None:
    """Where the tool is when the driver, with the believed gears, has brought it to X_WT."""
    arm = arm_kinematics()
    q = arm.inverse.follow(X_WT, arm.home, arm.inverse.branch(arm.home))
    if q is None:
        return None
    sag = model.sag(q, loaded=False)
    # The driver leads the motors by what is believed; what is true beyond that is left in the links.
    off = sag.links(true) - sag.links(x) + JOINTS * rng.standard_normal(6)
    return arm.chain.forward(q + off)
