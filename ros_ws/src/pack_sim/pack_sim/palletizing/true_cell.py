"""Where things of a real cell truly are, what its camera truly is, and where boxes arrive: from the seed."""

from __future__ import annotations

import numpy as np

from pack_core.camera import LensDistortion
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import OverheadCameraMount, PalletizingCell
from pack_core.palletizing.imperfections import CameraErrors, Displacement, PoseError
from pack_core.palletizing.scanner import SCANNED
from pack_core.rotations import Pose, from_yaw

FURNITURE, CAMERA, SCANNERS = 2, 3, 9
"""Streams of random numbers beside that of the arm's base: each error is the same whatever else is off."""


def true_cell(cell: PalletizingCell, seed: int) -> PalletizingCell:
    """The cell with tables, pallet, camera and scanners where they truly are.

    The arm's base is that of `true_base`. Sizes of the errors are those of the preset. A preset without such
    errors gives the cell back.
    """
    faults = cell.imperfections
    found: dict[str, object] = {}
    if faults.furniture.position or faults.furniture.orientation_deg:
        rng = np.random.default_rng([seed, FURNITURE])
        for name in ("picking_table", "reorientation_table", "pallet"):
            place = getattr(cell, name)
            found[name] = place.model_copy(update={"displacement": _drawn(faults.furniture, rng)})
    if faults.camera is not None:
        found["camera"] = _true_camera(cell.camera, faults.camera, np.random.default_rng([seed, CAMERA]))
    if faults.scanners.position or faults.scanners.orientation_deg:
        rng = np.random.default_rng([seed, SCANNERS])
        found["scanners"] = cell.scanners.model_copy(update={
            place: getattr(cell.scanners, place).model_copy(
                update={"displacement": _drawn(faults.scanners, rng)}
            )
            for place in SCANNED
        })  # fmt: skip
    return cell.model_copy(update=found) if found else cell


def _true_camera(
    mount: OverheadCameraMount, errors: CameraErrors, rng: np.random.Generator
) -> OverheadCameraMount:
    typical, spread = errors.lens.coefficients, errors.lens_spread
    k1, k2, p1, p2 = (float(k) for k in typical * (1.0 + rng.uniform(-spread, spread, 4)))
    u, v = (float(x) for x in rng.uniform(-errors.centre, errors.centre, 2))
    return mount.model_copy(
        update={
            "displacement": _drawn(errors.pose, rng),
            "focal_scale": float(1.0 + rng.uniform(-errors.focal, errors.focal)),
            "centre_shift": (u, v),
            "lens": LensDistortion(k1=k1, k2=k2, p1=p1, p2=p2),
        }
    )


def _drawn(error: PoseError, rng: np.random.Generator) -> Displacement:
    """A displacement of the given size in a random direction, about a random axis."""
    shift, axis = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
    turn = np.deg2rad(error.orientation_deg) * axis
    return Displacement.of([*(error.position * shift), *turn])


def arrival_pose(cell: PalletizingCell, box: BoxBody, seed: int) -> Pose:
    """X_WB of a box that arrives near the middle of the picking table, displaced and turned at random.

    The same seed and box give the same pose, whichever boxes arrived before: each box has its own generator.
    """
    rng = np.random.default_rng([seed, box.appearance])
    offset = rng.uniform(-cell.spawn.offset, cell.spawn.offset, 2)
    yaw = np.deg2rad(rng.uniform(-cell.spawn.yaw_deg, cell.spawn.yaw_deg))
    x, y = np.array(cell.picking_table.centre) + offset
    level = Pose(np.array([x, y, cell.picking_table.height + box.half_extents[2]]), from_yaw(yaw))
    return cell.picking_table.displaced(level)
