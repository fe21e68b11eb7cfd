"""Compares a scan with the boxes that must stand at its place.

The edges of the place say where the scanner really hangs. Each box is judged by its top face: is it there,
and where do its edges lie by the testimony of the rays on both sides of them? Then everything counts that is
nearer to the scanner than what is known to stand there.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose, from_matrix, from_yaw, multiply, rotate
from pack_perception.scans.face_fit import BoxTop, FaceFit, depths, fit_face
from pack_perception.scans.rays import Rays


class Oddity(Enum):
    """What can be wrong with what stands at a place."""

    MISSING = "missing"
    MOVED = "moved"
    OTHER = "other"
    FOREIGN = "foreign"


@dataclass(frozen=True)
class Finding:
    """One thing that is not as it should be.

    Attributes:
        oddity: what is wrong.
        box: name of the box that it is wrong with; empty for what belongs to no box.
        shift_W: how far a box was moved, in x and y `(2,)` [m].
        turn_deg: by how much a box was turned, seen from above.
        middle_W: where the middle of a foreign thing is, in x and y `(2,)` [m].
        size: of a foreign thing along x and y of the world, and its height over the place `(3,)` [m].
    """

    oddity: Oddity
    box: str = ""
    shift_W: Array = field(default_factory=lambda: np.zeros(2))
    turn_deg: float = 0.0
    middle_W: Array = field(default_factory=lambda: np.zeros(2))
    size: Array = field(default_factory=lambda: np.zeros(3))

    def __str__(self) -> str:
        """In words."""
        if self.oddity is Oddity.MISSING:
            return f"box {self.box} is gone"
        if self.oddity is Oddity.OTHER:
            return f"what stands in the place of box {self.box} is not of its size"
        if self.oddity is Oddity.MOVED:
            way, turn = 1e3 * float(np.linalg.norm(self.shift_W)), abs(self.turn_deg)
            return f"box {self.box} stands {way:.0f} mm and {turn:.1f} degrees from its place"
        (x, y), (length, width, height) = self.middle_W, self.size
        return (
            f"something of {length:.2f} x {width:.2f} x {height:.2f} m that should not be there, "
            f"at x = {x:.2f}, y = {y:.2f} m"
        )


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
    is_valid = (others > distances + 2.0 * height) & (rays.distances > distances - height)
    points, is_on = points[is_valid], (rays.distances < distances + height)[is_valid]
    tells = face.shows_edge(points)
    found = fit_face(points[tells], is_on[tells], face.half, slack)
    if np.any(np.abs(found.shift) > LARGEST) or np.any(found.sigma > SURE):
        return rays
    # The place appears at X_WF @ X_FG: the scan is moved back by that.
    X_WF = Pose(face.p_WF, from_matrix(face.R_WF))
    X_FG = Pose(np.array([*found.shift[:2], 0.0]), from_yaw(found.shift[2]))
    back = X_WF @ X_FG.inverse() @ X_WF.inverse()
    return replace(rays, p_W=back.apply(rays.p_W), directions_W=rotate(back.q, rays.directions_W))


TRACE = 0.3
"""Share of the rays to a box that must meet something at the height of its top, or it is not there."""
OUTLIERS = (0.02, 0.98)
"""Quantiles of its points that bound a foreign thing."""


class ScanTolerances(Config):
    """What a scan may differ by from what is expected."""

    height: PositiveFloat = Field(
        default=0.02,
        description="by which a ray meets something else if by more; noise is a few millimetres [m]",
    )
    position: PositiveFloat = Field(
        default=0.005, description="by which a box was moved along an edge if by more [m]"
    )
    angle_deg: PositiveFloat = Field(default=2.0, description="by which a box was turned if by more")
    slack: PositiveFloat = Field(
        default=0.012, description="beside an edge, in which rays may meet either side of it [m]"
    )
    reach: PositiveFloat = Field(
        default=0.15, description="around its place, in which a box is looked for when it was moved [m]"
    )
    area: PositiveFloat = Field(
        default=0.0025,
        description="of the least thing that counts, and of what must be seen of a box to judge it [m^2]",
    )
    share: float = Field(
        default=0.85, gt=0, le=1, description="of what is seen of a box's top that must have its height"
    )


@dataclass(frozen=True)
class ScannedScene:
    """What is compared with what.

    Attributes:
        rays: as measured.
        place: table or pallet, down to the floor.
        boxes: those that must stand on it.
        least: number of rays to the least thing that counts.
    """

    rays: Rays
    place: Obstacle
    boxes: tuple[Obstacle, ...]
    least: float


@dataclass(frozen=True)
class Judgement:
    """What is wrong with a box; None: nothing. And the box where it stands; None: it does not.

    A box that was moved has both.

    Attributes:
        certainty: of a box that was moved: by how many standard deviations.
    """

    finding: Finding | None
    standing: Obstacle | None
    certainty: float = 0.0


def compare(scene: ScannedScene, tolerances: ScanTolerances) -> tuple[Finding, ...]:
    """What is not as it should be; nothing where all is, as far as the scanner can see it.

    A box that was pushed against one as high looks as if that one were longer, and so moved. Of all boxes
    that seem to have moved the surest is believed, and the others are judged anew beside it where it stands.
    """
    rays = registered(scene.rays, scene.place, scene.boxes, tolerances.height, tolerances.slack)
    scene, moved = replace(scene, rays=rays), dict[str, Finding]()
    judged = _all_judged(scene, tolerances)
    while surest := _surest(judged, moved):
        finding, standing = surest
        moved[finding.box] = finding
        boxes = tuple(standing if box.name == finding.box else box for box in scene.boxes)
        scene = replace(scene, boxes=boxes)
        judged = _all_judged(scene, tolerances)
    findings = [*moved.values(), *(one.finding for one in judged if one.finding and not one.standing)]
    if not any(finding.oddity is Oddity.OTHER for finding in findings):  # that is a foreign thing itself
        findings += _foreign(scene, [one.standing for one in judged if one.standing is not None], tolerances)
    return tuple(findings)


def _surest(judged: Sequence[Judgement], moved: Collection[str]) -> tuple[Finding, Obstacle] | None:
    """Of the boxes that seem to have moved, but for those that are known to have, the surest."""
    seeming = [
        (one.certainty, one.finding, one.standing)
        for one in judged
        if one.finding and one.standing and one.finding.box not in moved
    ]
    if not seeming:
        return None
    _, finding, standing = max(seeming, key=lambda one: one[0])
    return finding, standing


def _all_judged(scene: ScannedScene, tolerances: ScanTolerances) -> list[Judgement]:
    others = _all_others(scene, tolerances.slack)
    return [_judged(scene, box, beside, tolerances) for box, beside in zip(scene.boxes, others, strict=True)]


def _all_others(scene: ScannedScene, slack: float) -> list[Array]:
    """For each box the distances `(n,)` [m] at which rays would meet all else that stands there."""
    if not scene.boxes:
        return []
    expected = scene.rays.up_to((scene.place, *scene.boxes), slack)
    nearest, (first, second) = expected.argmin(axis=1), np.partition(expected, 1, axis=1)[:, :2].T
    return [np.where(nearest == i, second, first) for i in range(1, expected.shape[1])]


def _judged(scene: ScannedScene, box: Obstacle, others: Array, limits: ScanTolerances) -> Judgement:
    """A box by its top face; `others` are the distances `(n,)` at which rays would meet all else there."""
    face, measured = BoxTop.of(box), scene.rays.distances
    points, distances = face.crossings(scene.rays)
    is_near = np.all(np.abs(points) < face.half + limits.reach, axis=1)
    # What covers the face, and neighbours of nearly its height, hide where it ends.
    is_clear = others > distances + 2.0 * limits.height
    is_valid = is_near & is_clear & (measured > distances - limits.height)
    points, is_on = points[is_valid], (measured < distances + limits.height)[is_valid]
    is_inside = depths(points, face.half, np.zeros(3)) > limits.slack
    if is_inside.sum() < scene.least:
        return Judgement(None, box)
    if is_on.sum() < TRACE * is_inside.sum():
        is_bare = np.median((others - measured)[is_valid][is_inside]) < limits.height
        return Judgement(Finding(Oddity.MISSING if is_bare else Oddity.OTHER, box.name), None)
    tells = face.shows_edge(points)
    found = fit_face(points[tells], is_on[tells], face.half, limits.slack)
    is_inside = depths(points, face.half, found.shift) > limits.slack
    if is_on[is_inside].sum() < limits.share * max(1, is_inside.sum()):
        return Judgement(Finding(Oddity.OTHER, box.name), None)
    return _moved(box, face, found, limits)


def _moved(box: Obstacle, face: BoxTop, found: FaceFit, limits: ScanTolerances) -> Judgement:
    """A box that is there; it was moved if by more than is allowed and than its rays leave open."""
    allowed = np.array([limits.position, limits.position, np.deg2rad(limits.angle_deg)])
    if np.all(np.abs(found.shift) <= allowed + 2.0 * found.sigma):
        return Judgement(None, box)
    shift_W, q_turn = face.R_WF[:, :2] @ found.shift[:2], from_yaw(found.shift[2])
    p_WO = face.p_WF + shift_W + rotate(q_turn, box.X_WO.p - face.p_WF)
    standing = Obstacle(box.name, Pose(p_WO, multiply(q_turn, box.X_WO.q)), box.size)
    turn_deg = float(np.rad2deg(found.shift[2]))
    certainty = float(np.max(np.abs(found.shift) / found.sigma))
    return Judgement(Finding(Oddity.MOVED, box.name, shift_W[:2], turn_deg), standing, certainty)


def _foreign(scene: ScannedScene, boxes: Sequence[Obstacle], limits: ScanTolerances) -> list[Finding]:
    """What is nearer to the scanner than the place and all that stands on it, if there is anything."""
    rays, place = scene.rays, scene.place
    expected = rays.up_to((place, *boxes), limits.slack).min(axis=1)
    ends_P = place.X_WO.inverse().apply(rays.ends_W)
    is_over = np.all(np.abs(ends_P[:, :2]) < 0.5 * place.size[:2] + limits.slack, axis=1)
    is_odd = is_over & (rays.distances < expected - limits.height)
    if is_odd.sum() < scene.least:
        return []
    low, high = np.quantile(rays.ends_W[is_odd, :2], OUTLIERS, axis=0)
    top = float(np.quantile(ends_P[is_odd, 2], OUTLIERS[1]) - 0.5 * place.size[2])
    return [Finding(Oddity.FOREIGN, middle_W=0.5 * (low + high), size=np.array([*(high - low), top]))]
