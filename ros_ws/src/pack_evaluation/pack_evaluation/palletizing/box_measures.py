"""The measures of one box of a palletizing run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.config import Config
from pack_core.rotations import angle_between
from pack_evaluation.palletizing.run import BoxRecord, PalletRun


class PlacementCriteria(Config):
    """Largest errors, in position [m] and orientation [deg], of a correctly placed box."""

    position: float = 0.005
    orientation_deg: float = 1.0


@dataclass(frozen=True)
class BoxMeasures:
    """The measures of one box.

    Attributes:
        name: name of the box.
        handling: none, flip or table.
        outcome: placed, skipped, lost or pending.
        is_ok: whether it was placed and meets the criteria at the end.
        error_mm: distance from its planned position at the end; None if it was not placed.
        angle_deg: angle from its planned orientation at the end; None if it was not placed.
        cycle_s: cycle time; None if it was not placed.
        coaxial_N: largest coaxial force of its grips; None if it was not gripped.
        shear_N: largest shear force of its grips; None if it was not gripped.
        moment_Nm: largest bending moment of its grips; None if it was not gripped.
    """

    name: str
    handling: str
    outcome: str
    is_ok: bool
    error_mm: float | None
    angle_deg: float | None
    cycle_s: float | None
    coaxial_N: float | None
    shear_N: float | None
    moment_Nm: float | None


def measure_box(run: PalletRun, box: BoxRecord, criteria: PlacementCriteria) -> BoxMeasures:
    """Measure one box of a run."""
    error_mm = angle_deg = None
    is_ok = False
    if box.outcome == "placed":
        X_WB = run.tracks[box.name].at(float("inf"))
        error_mm = 1e3 * float(np.linalg.norm(X_WB.p - box.X_WB.p))
        angle_deg = float(np.degrees(angle_between(X_WB.q, box.X_WB.q)))
        is_ok = error_mm <= 1e3 * criteria.position and angle_deg <= criteria.orientation_deg
    coaxial, shear, moment = run.grip_peaks.get(box.name, (None, None, None))
    return BoxMeasures(
        box.name, box.handling, box.outcome, is_ok, error_mm, angle_deg, run.cycles.get(box.name),
        coaxial, shear, moment,
    )  # fmt: skip
