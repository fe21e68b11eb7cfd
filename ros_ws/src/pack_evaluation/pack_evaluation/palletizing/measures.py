"""The measures of one run of the palletizing cell; docs/cells/palletizing/results.md defines them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated

import numpy as np
import numpy.typing as npt

from pack_core.config import Config
from pack_core.palletizing.orders.order import Order
from pack_core.rotations import Array, angle_between
from pack_evaluation.palletizing.run import BoxRecord, PalletRun, SeparationTrack, ToolTrack
from pack_evaluation.palletizing.state_times import StateTime, near_contact_peak, state_times, tool_speeds
from pack_evaluation.table import MeasureText, mean_and_max, number, yes_or_no

CLEAR_STATE = "17 pre deposit"
"""Shifts are measured between two entries of this state: a box is about to come down on the stack."""
GOAL_STATES = ("4 lift", "9 step back", "13 lift table", "19 retreat")
"""States that are entered when a goal was reached and the gripper has acted."""
CROSSING = 1.0
"""A visitor that comes nearer to the arm than this makes a crossing [m]; it ends when it is farther again."""
KEPT = 0.1
"""Distance that is to be kept [m]."""
STANDS = 0.02
"""Speed below which the tool stands [m/s]."""


def _errors(boxes: Sequence[BoxMeasures]) -> str:
    return _mean_and_max([box.error_mm for box in boxes if box.error_mm is not None], "mm")


def _weights(boxes: Sequence[BoxMeasures]) -> str:
    errors = [box.weight_error_kg for box in boxes if box.weight_error_kg is not None]
    return _mean_and_max([abs(error) for error in errors], "kg")


def _peak_near_contact(states: Mapping[str, StateTime]) -> str:
    return f"{near_contact_peak(states):.2f} m/s"


def _cycles(boxes: Sequence[BoxMeasures]) -> str:
    return _mean_and_max([box.cycle_s for box in boxes if box.cycle_s is not None], "s")


def _shifts(values: Sequence[float]) -> str:
    return _mean_and_max(values, "mm")


def _mean_and_max(values: Sequence[float], unit: str) -> str:
    return f"{np.mean(values):.2f}, {np.max(values):.2f} {unit}" if values else "-"


def _optional(unit: str) -> Callable[[tuple[float, float] | None], str]:
    """The mean and the largest value as text, or a dash."""
    return lambda values: "-" if values is None else mean_and_max(unit)(values)


@dataclass(frozen=True)
class OrderMeasures:
    """What is measured of an order, most important first."""

    is_complete: Annotated[bool, MeasureText("complete", yes_or_no, "every box within 5 mm and 1 degree")]
    reward: Annotated[int, MeasureText("reward", str, "boxes within these bounds (section 8.7)")]
    penalty: Annotated[int, MeasureText("penalty", str, "boxes not within them")]
    boxes: Annotated[
        tuple[BoxMeasures, ...],
        MeasureText("placement error", _errors, "mean, largest; at the end, true"),
        MeasureText("cycle", _cycles, "mean, longest; simulated"),
        MeasureText("weight", _weights, "mean, largest error of what the arm weighed"),
    ]
    position_mm: Annotated[
        tuple[float, float],
        MeasureText(
            "tracking, position",
            mean_and_max("mm"),
            "mean, largest; commanded to measured tool",
        ),
    ]
    orientation_deg: Annotated[
        tuple[float, float], MeasureText("tracking, orientation", mean_and_max("deg"), "mean, largest")
    ]
    goal_mm: Annotated[
        tuple[float, float],
        MeasureText("at goals", mean_and_max("mm"), "mean, largest; where the gripper acted"),
    ]
    shift_mm: Annotated[
        tuple[float, ...],
        MeasureText("shift of earlier boxes", _shifts, "mean, largest of what each placement moved"),
    ]
    drops: Annotated[int, MeasureText("drops", str, "boxes that the gripper lost")]
    touches: Annotated[int, MeasureText("unwanted contacts", str, "over 20 N")]
    interruptions: Annotated[
        int, MeasureText("interruptions", str, "setpoints too late, the driver held the arm: a slow machine")
    ]
    faults: Annotated[
        tuple[str, ...],
        MeasureText("faults", lambda found: str(len(found)), lambda m: "; ".join(m.faults) or "none"),
    ]
    duration_s: Annotated[float, MeasureText("duration", number("s", 1), "simulated")]
    true_position_mm: Annotated[
        tuple[float, float] | None,
        MeasureText(
            "path of the true tool",
            lambda m: "-" if m is None else mean_and_max("mm")(m),
            "mean, largest; commanded to true tool, in the frame of the arm's base",
        ),
    ] = None
    way_point_mm: Annotated[
        tuple[float, float] | None,
        MeasureText(
            "at way-points, position",
            _optional("mm"),
            "mean, largest; measured tool to target when the checker confirms it: the thesis's Table 9.1",
        ),
    ] = None
    way_point_deg: Annotated[
        tuple[float, float] | None,
        MeasureText("at way-points, orientation", _optional("deg"), "mean, largest"),
    ] = None
    states: Annotated[
        Mapping[str, StateTime],
        MeasureText(
            "speed near contact",
            _peak_near_contact,
            "highest speed of the tool within 0.1 m of where the gripper acts",
        ),
    ] = field(default_factory=dict)
    visitors: Annotated[
        VisitorMeasures | None,
        MeasureText("visitors", visitors_text, "crossings, and the least distance from the arm"),
    ] = None


def measure_order(run: PalletRun, criteria: PlacementCriteria | None = None) -> OrderMeasures:
    """Measure a run of an order."""
    boxes = tuple(measure_box(run, box, criteria or PlacementCriteria()) for box in run.boxes)
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
        true_position_mm=_true_errors(run.tool), states=state_times(run), visitors=measure_visitors(run),
        way_point_mm=_of_way_points([point.position_mm for point in run.way_points]),
        way_point_deg=_of_way_points([point.orientation_deg for point in run.way_points]),
    )  # fmt: skip


def measures_of_unbuilt(order: Order, reason: str) -> OrderMeasures:
    """The measures of an order of which nothing was built, for a reason."""
    boxes = tuple(
        BoxMeasures(box.id, box.turn.handling.value, "pending", False, None, None, None, None, None, None)
        for box in order.boxes
    )
    return OrderMeasures(
        is_complete=False, reward=0, penalty=len(boxes), boxes=boxes, position_mm=(0.0, 0.0),
        orientation_deg=(0.0, 0.0), goal_mm=(0.0, 0.0), shift_mm=(), drops=0, touches=0, interruptions=0,
        faults=(reason,), duration_s=0.0,
    )  # fmt: skip


def tracking_errors(tool: ToolTrack) -> tuple[Array, Array]:
    """Distance [mm] and angle [deg] between commanded and measured tool at every step, each `(n,)`."""
    position_mm = 1e3 * np.linalg.norm(tool.p - tool.p_ref, axis=1)
    return position_mm, np.degrees(angle_between(tool.q_ref, tool.q))


def _true_errors(tool: ToolTrack) -> tuple[float, float] | None:
    if tool.p_true is None:
        return None
    return _mean_max(1e3 * np.linalg.norm(tool.p_true - tool.p_ref, axis=1))


def shifts_mm(run: PalletRun) -> tuple[float, ...]:
    """For each placement, how far it moved any box that had come to rest before it [mm].

    Boxes are compared between the moments at which one box and the next come down, so that the fall of a
    box from the gripper onto its place is not counted.
    """
    downs = [(visit.time, visit.box) for visit in run.visits if visit.state == CLEAR_STATE]
    # A box whose way down was interrupted comes down from the first of its moments on.
    moments = [now for before, now in pairwise([(0.0, ""), *downs]) if now[1] != before[1]]
    moments.append((float(run.tool.times[-1]), ""))
    found: list[float] = []
    placed: list[str] = []
    for (start, name), (end, _) in pairwise(moments):
        moved = [
            1e3
            * float(np.linalg.norm(run.tracks[other].last_pose(end).p - run.tracks[other].last_pose(start).p))
            for other in placed
        ]
        if moved:
            found.append(max(moved))
        placed.append(name)
    return tuple(found)


def _of_way_points(values: Sequence[float]) -> tuple[float, float] | None:
    return _mean_max(np.array(values)) if values else None


def _mean_max(values: Array) -> tuple[float, float]:
    return (float(values.mean()), float(values.max())) if len(values) else (0.0, 0.0)


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
        weight_error_kg: what the arm weighed it less what it was told to weigh; None if it was not weighed.
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
    weight_error_kg: float | None = None


def measure_box(run: PalletRun, box: BoxRecord, criteria: PlacementCriteria) -> BoxMeasures:
    """Measure one box of a run."""
    error_mm = angle_deg = None
    is_ok = False
    if box.outcome == "placed":
        X_WB = run.tracks[box.name].pose(-1)
        error_mm = 1e3 * float(np.linalg.norm(X_WB.p - box.X_WB.p))
        angle_deg = float(np.degrees(angle_between(X_WB.q, box.X_WB.q)))
        is_ok = error_mm <= 1e3 * criteria.position and angle_deg <= criteria.orientation_deg
    coaxial, shear, moment = run.grip_peaks.get(box.name, (None, None, None))
    return BoxMeasures(
        box.name, box.handling, box.outcome, is_ok, error_mm, angle_deg, run.cycles.get(box.name),
        coaxial, shear, moment, None if box.weighed is None else box.weighed - box.mass,
    )  # fmt: skip


@dataclass(frozen=True)
class VisitorMeasures:
    """Visitors in a run.

    Attributes:
        crossings: how often a visitor came near the arm.
        least_m: the least distance in each crossing, from the arm or what it carries [m].
        near_s: time in which a visitor was near [s].
        stopped_s: part of it in which the tool stood [s].
        too_near: crossings with less than the distance that is to be kept.
        touches: unwanted contacts with a visitor.
        margin_m: the least distance beyond the protective separation distance while the arm was under way
            [m]; None where it was not recorded.
    """

    crossings: int
    least_m: tuple[float, ...]
    near_s: float
    stopped_s: float
    too_near: int
    touches: int
    margin_m: float | None


def measure_visitors(run: PalletRun) -> VisitorMeasures | None:
    """The measures of a run's visitors; None where there were none."""
    if not run.visitors:
        return None
    least: list[float] = []
    near_s = stopped_s = 0.0
    speeds = tool_speeds(run)
    for track in run.visitors.values():
        is_near = track.distance < CROSSING
        for first, beyond in _intervals(is_near):
            least.append(float(track.distance[first:beyond].min()))
        step = float(np.median(np.diff(track.times))) if len(track.times) > 1 else 0.0
        tool = np.interp(track.times, run.tool.times, speeds)
        near_s += step * float(is_near.sum())
        stopped_s += step * float((is_near & (tool < STANDS)).sum())
    touches = sum(any(name in run.visitors for name in touch.bodies) for touch in run.touches)
    return VisitorMeasures(
        len(least), tuple(least), near_s, stopped_s, sum(distance < KEPT for distance in least), touches,
        _margin(run.separation),
    )  # fmt: skip


def _margin(track: SeparationTrack | None) -> float | None:
    seen = None if track is None else track.margin[track.is_under_way & np.isfinite(track.margin)]
    return float(seen.min()) if seen is not None and len(seen) else None


def visitors_text(found: VisitorMeasures | None) -> str:
    """The measures in a line of a table."""
    if found is None:
        return "-"
    nearest = f"{min(found.least_m):.2f} m" if found.least_m else "-"
    margin = "" if found.margin_m is None else f", margin {found.margin_m:.3f} m"
    return f"{found.crossings} crossings, {nearest}{margin}; {found.touches} contacts"


def _intervals(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First index, and index beyond the last, of every run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(edges[k]), int(edges[k + 1])) for k in range(0, len(edges), 2)]
