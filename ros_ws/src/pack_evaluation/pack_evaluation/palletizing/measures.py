"""The measures of one run of the palletizing cell; docs/palletizing/measurements.md defines them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pack_core.config import Config
from pack_core.rotations import Array, angle_between
from pack_evaluation.palletizing.run import BoxRecord, PalletRun, ToolTrack

CLEAR_STATE = "17 pre deposit"
"""From here to its end nothing but the box in the hand may move the stack: shifts are taken between these."""
GOAL_STATES = ("4 lift", "9 step back", "13 lift table", "19 retreat")
"""Entered when a goal was reached and the gripper has acted."""


class PlacementCriteria(Config):
    """When a box counts as placed correctly."""

    position: float = 0.005
    """[m]"""
    orientation_deg: float = 1.0


@dataclass(frozen=True)
class BoxMeasures:
    """One box.

    Attributes:
        name: of the box.
        handling: none, flip or table.
        outcome: placed, skipped, lost or pending.
        is_ok: placed, and at the end within the criteria.
        error_mm: at the end, from where it was to stand; None if it is not on the pallet.
        angle_deg: the same, turned by.
        cycle_s: None if it was not placed.
        coaxial_N: worst load of its grips; None if it was not gripped.
        shear_N: the same.
        moment_Nm: the same.
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


@dataclass(frozen=True)
class OrderMeasures:
    """One run.

    Attributes:
        is_complete: every box was placed within the criteria.
        reward: boxes within the criteria (section 8.7).
        penalty: boxes that are not.
        boxes: one by one.
        position_mm: tracking error of the tool, mean and largest over all steps.
        orientation_deg: the same, of its orientation.
        goal_mm: position error where a gripper acted, mean and largest.
        shift_mm: by how far each placement moved boxes that stood already, the largest of each.
        drops: boxes that the gripper lost.
        touches: unwanted contacts.
        interruptions: how often setpoints came too late and the driver held the arm in a move.
        faults: every fault with its reason.
        duration_s: of the run.
    """

    is_complete: bool
    reward: int
    penalty: int
    boxes: tuple[BoxMeasures, ...]
    position_mm: tuple[float, float]
    orientation_deg: tuple[float, float]
    goal_mm: tuple[float, float]
    shift_mm: tuple[float, ...]
    drops: int
    touches: int
    interruptions: int
    faults: tuple[str, ...]
    duration_s: float


def measure_order(run: PalletRun, criteria: PlacementCriteria | None = None) -> OrderMeasures:
    """Measure a run."""
    boxes = tuple(_measure_box(run, box, criteria or PlacementCriteria()) for box in run.boxes)
    position_mm, angle_deg = tracking_errors(run.tool)
    goals = [visit.time for visit in run.visits if visit.state in GOAL_STATES]
    at_goals = position_mm[np.clip(run.tool.times.searchsorted(goals), 0, len(position_mm) - 1)]
    reward = sum(box.is_ok for box in boxes)
    return OrderMeasures(
        is_complete=reward == len(boxes), reward=reward, penalty=len(boxes) - reward, boxes=boxes,
        position_mm=_mean_max(position_mm), orientation_deg=_mean_max(angle_deg), goal_mm=_mean_max(at_goals),
        shift_mm=shifts_mm(run), drops=sum(box.outcome == "lost" for box in boxes), touches=len(run.touches),
        interruptions=run.interruptions,
        faults=tuple(f"{visit.state}: {visit.reason}" for visit in run.visits if visit.reason),
        duration_s=float(run.tool.times[-1] - run.tool.times[0]),
    )  # fmt: skip


def tracking_errors(tool: ToolTrack) -> tuple[Array, Array]:
    """Distance [mm] and angle [deg] between commanded and measured tool at every step, each `(n,)`."""
    position_mm = 1e3 * np.linalg.norm(tool.p - tool.p_ref, axis=1)
    return position_mm, np.degrees(angle_between(tool.q_ref, tool.q))


def shifts_mm(run: PalletRun) -> tuple[float, ...]:
    """For each placement, how far it moved any box that had come to rest before it [mm].

    Boxes are compared between the moments at which one box and the next come down, so that the fall of a
    box from the gripper onto its place is not counted.
    """
    moments = [(visit.time, visit.box) for visit in run.visits if visit.state == CLEAR_STATE]
    moments.append((float(run.tool.times[-1]), ""))
    found: list[float] = []
    placed: list[str] = []
    for (start, name), (end, _) in pairwise(moments):
        moved = [
            1e3 * float(np.linalg.norm(run.tracks[other].at(end).p - run.tracks[other].at(start).p))
            for other in placed
        ]
        if moved:
            found.append(max(moved))
        placed.append(name)
    return tuple(found)


def _measure_box(run: PalletRun, box: BoxRecord, criteria: PlacementCriteria) -> BoxMeasures:
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


def _mean_max(values: Array) -> tuple[float, float]:
    return (float(values.mean()), float(values.max())) if len(values) else (0.0, 0.0)
