"""Where a scanner really hangs over its place, by the edges of the place itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.rotations import Pose, from_matrix, from_yaw, rotate
from pallet_fsm.scans.box_top import BoxTop
from pallet_fsm.scans.face_fit import fit_face
from pallet_fsm.scans.rays import Rays

LARGEST = np.array([0.012, 0.012, np.deg2rad(0.5)])
"""What a scanner may hang askew by, as its place appears [m, m, rad]; more: the place itself was moved."""
SURE = np.array([0.001, 0.001, np.deg2rad(0.1)])
"""What the edges that are seen must leave open at most [m, m, rad]."""


def registered(rays: Rays, place: Obstacle, boxes: Sequence[Obstacle], height: float, slack: float) -> Rays:
    """The rays as they would be if the scanner hung where it is taken to hang.

    The place is known by the arm, which touched it in a calibration; its edges in the scan say how far the
    scanner is from where it should be, seen from above. Rays are left as they are where they do not say it.

    Args:
        rays: as measured.
        place: table or pallet, down to the floor.
        boxes: those that must stand on it, and hide some of its edges.
        height: by which a ray meets something else if by more [m].
        slack: beside an edge, in which rays may meet either side of it [m].
    """
    face = BoxTop.of(place)
    points, distances = face.crossings(rays)
    others = np.column_stack([rays.up_to(boxes, slack), np.full(len(points), np.inf)]).min(axis=1)
    is_told = (others > distances + 2.0 * height) & (rays.distances > distances - height)
    points, is_on = points[is_told], (rays.distances < distances + height)[is_told]
    tells = face.is_told(points)
    found = fit_face(points[tells], is_on[tells], face.half, slack)
    if np.any(np.abs(found.shift) > LARGEST) or np.any(found.sigma > SURE):
        return rays
    # The place appears at X_WF @ X_FG: the scan is moved back by that.
    X_WF = Pose(face.p_WF, from_matrix(face.R_WF))
    X_FG = Pose(np.array([*found.shift[:2], 0.0]), from_yaw(found.shift[2]))
    back = X_WF @ X_FG.inverse() @ X_WF.inverse()
    return replace(rays, p_W=back.apply(rays.p_W), directions_W=rotate(back.q, rays.directions_W))
