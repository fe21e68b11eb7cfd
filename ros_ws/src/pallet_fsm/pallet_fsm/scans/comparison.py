"""Compares a scan with the boxes that must stand at its place.

Each box is judged by its top face: is it there, and where do its edges lie by the testimony of the rays on both
sides of them? Then everything is compared that is nearer to the scanner than any box that is known of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose, from_yaw, multiply, rotate
from pallet_fsm.scans.face_fit import FaceFit, depths, fit_face
from pallet_fsm.scans.findings import Finding, Oddity
from pallet_fsm.scans.rays import Rays
from pallet_fsm.scans.top_face import TopFace


class ScanTolerances(Config):
    """What a scan may differ by from what is expected."""

    height: PositiveFloat = Field(
        default=0.02, description="rays that differ by less meet what they should [m]; noise is a few millimetres"
    )
    position: PositiveFloat = Field(default=0.008, description="by which a box was moved if by more [m]")
    angle_deg: PositiveFloat = Field(default=2.0, description="by which a box was turned if by more")
    slack: PositiveFloat = Field(
        default=0.012, description="beside an edge, in which rays may meet either side of it [m]"
    )
    reach: PositiveFloat = Field(
        default=0.15, description="beside a box, in which it is looked for when it is not in its place [m]"
    )
    area: PositiveFloat = Field(
        default=0.0025, description="seen from above, of the least thing that counts, and of what must be seen "
        "of a box to judge it [m^2]",
    )  # fmt: skip
    share: float = Field(
        default=0.85, gt=0, le=1, description="of what is seen of a box's top that must have its height"
    )


@dataclass(frozen=True)
class Scene:
    """What is compared with what.

    Attributes:
        rays: as measured.
        place: table or pallet, down to the floor.
        boxes: those that must stand on it.
        spacing: of the rays at the level of the place [m].
    """

    rays: Rays
    place: Obstacle
    boxes: tuple[Obstacle, ...]
    spacing: float


def compare(scene: Scene, tolerances: ScanTolerances) -> tuple[Finding, ...]:
    """What is not as it should be; nothing where all is, as far as the scanner can see it."""
    expected = scene.rays.up_to((scene.place, *scene.boxes), tolerances.slack)
    findings, standing = [], []
    for i, box in enumerate(scene.boxes):
        others = np.delete(expected, i + 1, axis=1).min(axis=1)
        finding, found = _judged(scene, box, others, tolerances)
        findings += [] if finding is None else [finding]
        standing.append(found)
    foreign = _foreign(scene, [box for box in standing if box is not None], tolerances)
    is_explained = any(finding.oddity is Oddity.OTHER for finding in findings)
    return (*findings, *(() if foreign is None or is_explained else (foreign,)))


def _judged(
    scene: Scene, box: Obstacle, others: Array, tolerances: ScanTolerances
) -> tuple[Finding | None, Obstacle | None]:
    """What is wrong with a box, and the box where it really stands; none of it where it does not.

    `others` are the distances `(n,)` at which rays would meet what else stands there.
    """
    face, limits = TopFace.of(box), tolerances
    points, distances = face.crossings(scene.rays)
    measured = scene.rays.distances
    is_near = np.all(np.abs(points) < face.half + limits.reach, axis=1)
    # What covers the face, and neighbours of nearly its height, hide where it ends.
    is_clear = others > distances + 2.0 * limits.height
    is_told = is_near & is_clear & (measured > distances - limits.height)
    points, is_on = points[is_told], (measured < distances + limits.height)[is_told]
    least = limits.area / scene.spacing**2  # rays; those to a higher face are denser, so that more are asked for
    is_inside = depths(points, face.half, np.zeros(3)) > limits.slack
    if is_inside.sum() < least:
        return None, box
    if is_on.sum() < 0.3 * is_inside.sum():
        is_bare = np.median((others - measured)[is_told][is_inside]) < limits.height
        return Finding(Oddity.MISSING if is_bare else Oddity.OTHER, box.name), None
    tells = face.is_told(points)
    found = fit_face(points[tells], is_on[tells], face.half, limits.slack)
    is_inside = depths(points, face.half, found.shift) > limits.slack
    if is_on[is_inside].mean() < limits.share:
        return Finding(Oddity.OTHER, box.name), None
    return _moved(box, face, found, limits)


def _moved(
    box: Obstacle, face: TopFace, found: FaceFit, tolerances: ScanTolerances
) -> tuple[Finding | None, Obstacle]:
    """The finding where a box was moved by more than is allowed and more than the rays leave open."""
    most = np.array([tolerances.position, tolerances.position, np.deg2rad(tolerances.angle_deg)])
    if np.all(np.abs(found.shift) <= most + 2.0 * found.sigma):
        return None, box
    way_W, q_turn = face.R_WF[:, :2] @ found.shift[:2], from_yaw(found.shift[2])
    below = rotate(q_turn, box.X_WO.p - face.p_WF)
    X_WO = Pose(face.p_WF + way_W + below, multiply(q_turn, box.X_WO.q))
    return Finding(Oddity.MOVED, box.name, way_W[:2], float(np.rad2deg(found.shift[2]))), Obstacle(box.name, X_WO, box.size)


def _foreign(scene: Scene, boxes: Sequence[Obstacle], tolerances: ScanTolerances) -> Finding | None:
    """What is nearer to the scanner than the place and all that stands on it."""
    rays, slack = scene.rays, tolerances.slack
    expected = rays.up_to((scene.place, *boxes), slack).min(axis=1)
    X_WP, ends = scene.place.X_WO, rays.ends_W
    local = rotate(X_WP.inverse().q, ends - X_WP.p)
    is_over = np.all(np.abs(local[:, :2]) < 0.5 * scene.place.size[:2] + slack, axis=1)
    is_odd = is_over & (rays.distances < expected - tolerances.height)
    if is_odd.sum() * scene.spacing**2 < tolerances.area:
        return None
    points, level = ends[is_odd], 0.5 * scene.place.size[2]
    low, high = np.quantile(points[:, :2], (0.02, 0.98), axis=0)
    top = float(np.quantile(local[is_odd, 2], 0.98)) - level
    return Finding(Oddity.FOREIGN, "", 0.5 * (low + high), 0.0, np.array([*(high - low), top]))
