"""The measures of a run: those of the paper's tables and of its Eqs. 7 to 9, and what they leave open."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from pack_core.packing.goals import PackingExitReason
from pack_core.packing.load_shedding import GivenUp, given_up
from pack_core.rotations import Array, to_matrix
from pack_evaluation.packing.criteria import Criteria, exit_reason, is_packed
from pack_evaluation.packing.force import chatter, low_pass
from pack_evaluation.packing.prediction import (
    held_position_errors,
    held_rotation_errors,
    position_errors,
    predict,
)
from pack_evaluation.packing.run import Run
from pack_evaluation.table import MeasureText, number, yes_or_no

NAN = float("nan")
DEG = math.degrees(1.0)
"""Degrees in a radian."""
CYCLE_MS = 48.0
"""Time that an iteration of the controller may take, its cycle in lockstep [ms]."""
TOLERANCE = 0.003
"""An object contained may stick out by this [m]: contact gives way by fractions of a millimetre, and under
`hardware` the true sizes of object and container differ from the described ones by 2 and 3 mm."""


@dataclass(frozen=True)
class PackingMeasures:
    """What is measured of a run, most important first; NaN where there is nothing to measure."""

    success: Annotated[
        bool, MeasureText("packed", yes_or_no, "lowered onto its place: in FINE-TUNE, or by INSERT")
    ]
    exit_reason: Annotated[PackingExitReason, MeasureText("exit", lambda e: e.value, "how the goal ended")]
    execution_time: Annotated[
        float, MeasureText("execution time", number("s"), "simulated, from the goal to its end")
    ]
    """[s]"""
    distance: Annotated[
        float,
        MeasureText("final distance", number("cm", factor=1e2), "from the object to its packing pose, true"),
    ]
    """[m]"""
    is_contained: Annotated[
        bool,
        MeasureText("contained", yes_or_no, "ends between the walls, its centre below the rim (section II)"),
    ]
    protrusion: Annotated[
        float,
        MeasureText("protrusion", number("mm", 1, 1e3), "at the end beyond the walls' inner faces, true"),
    ]
    """[m]"""
    top_over_rim: Annotated[
        float, MeasureText("top over the rim", number("cm", 1, 1e2), "highest point at the end, true")
    ]
    """[m]"""
    tilt: Annotated[
        float, MeasureText("tilt", number("deg", 1, DEG), "of the object's axis from the vertical at the end")
    ]
    """[rad]"""
    force_mean: Annotated[
        float, MeasureText("force, mean", number("N"), "load on the cup less the object's weight")
    ]
    """[N]"""
    force_p95: Annotated[float, MeasureText("force, 95 %", number("N"), "percentile of it")]
    """[N]"""
    force_peak: Annotated[
        float, MeasureText("force, peak", number("N"), "its maximum, behind a 5 ms low-pass")
    ]
    """[N]"""
    chatter: Annotated[
        float,
        MeasureText(
            "chatter", number("%", 1, 1e2), "of samples in contact, over 5 N off the sample 8 ms before"
        ),
    ]
    """Share from 0 to 1."""
    iteration_ms: Annotated[
        float,
        MeasureText("MPC iteration", number("ms", 1), lambda m: f"wall clock, median of {m.iterations}"),
    ]
    iteration_ms_p95: Annotated[
        float, MeasureText("MPC iteration, 95 %", number("ms", 1), "percentile of it")
    ]
    late: Annotated[
        float, MeasureText("late iterations", number("%", 1, 1e2), f"took over {CYCLE_MS:.0f} ms")
    ]
    """Share from 0 to 1."""
    very_late: Annotated[
        float, MeasureText("very late iterations", number("%", 1, 1e2), f"took over {2 * CYCLE_MS:.0f} ms")
    ]
    """Share from 0 to 1."""
    given_up: Annotated[
        float,
        MeasureText("under load", number("%", 1, 1e2), "of the iterations gave something up"),
    ]
    """Share from 0 to 1."""
    iterations: int
    """Number of the controller's iterations."""
    placements: Annotated[int, MeasureText("placements", str, "packing poses that were tried")]
    displacement: Annotated[
        float,
        MeasureText("displacement", number("cm", factor=1e2), "of the objects in the container, summed"),
    ]
    """[m]"""
    m_pos: Annotated[
        float,
        MeasureText("M_pos", number("mm", factor=1e3), "error of the model's predicted positions (Eq. 7)"),
    ]
    """[m]"""
    m_rot: Annotated[
        float, MeasureText("M_rot", number("deg", factor=DEG), "rotation about the pump tip (Eq. 8)")
    ]
    """[rad]"""
    m_per: Annotated[
        float, MeasureText("M_per", number("objects"), "not seen but predicted, on average (Eq. 9)")
    ]
    grip_error: Annotated[
        float,
        MeasureText("grip error", number("mm", factor=1e3), "held object, from where a rigid grip has it"),
    ]
    """[m]"""
    perception_error: Annotated[
        float, MeasureText("perception error", number("mm", factor=1e3), "of the objects in the container")
    ]
    """[m]"""
    perception_angle: Annotated[
        float, MeasureText("perception error, held", number("deg", factor=DEG), "rotation of the held object")
    ]
    """[rad]"""
    real_time_factor: Annotated[
        float, MeasureText("real-time factor", number(""), "simulated seconds a second, achieved")
    ]


def measure(run: Run) -> PackingMeasures:
    """Measure a run; the same function serves live runs, `pack evaluate` and the benchmarks."""
    times, force = goal_force(run)
    iterations, end, model = run.iterations, containment(run), predict(run)
    placements = iterations.placements[-1] if iterations.times.size else run.outcome.get("placements", 0)
    return PackingMeasures(
        success=is_packed(run), exit_reason=exit_reason(run, Criteria()),
        execution_time=run.end - run.start, distance=final_distance(run),
        is_contained=end.is_contained, protrusion=end.protrusion, top_over_rim=end.top_over_rim,
        tilt=end.tilt,
        force_mean=_mean(force), force_p95=_percentile(force, 95),
        force_peak=_percentile(low_pass(times, force), 100), chatter=chatter(times, force),
        iteration_ms=_percentile(iterations.ms, 50), iteration_ms_p95=_percentile(iterations.ms, 95),
        late=_mean(iterations.ms > CYCLE_MS), very_late=_mean(iterations.ms > 2 * CYCLE_MS),
        given_up=_mean(np.array(given_up(iterations.times)) > GivenUp.NOTHING),
        iterations=iterations.times.size, placements=int(placements),
        m_pos=_mean(position_errors(run, model)), m_rot=_mean(held_rotation_errors(run, model)),
        m_per=predicted_objects(run), grip_error=_mean(held_position_errors(run, model)),
        perception_error=_mean(position_errors(run, run.estimate)),
        perception_angle=_mean(held_rotation_errors(run, run.estimate)),
        displacement=sum(object_displacements(run).values()), real_time_factor=_mean(run.real_time_factors),
    )  # fmt: skip


def goal_force(run: Run) -> tuple[Array, Array]:
    """Times `(n,)` [s] and magnitudes `(n,)` [N] of the force within the goal."""
    rows = (run.force_times >= run.start) & (run.force_times <= run.end)
    return run.force_times[rows], run.force[rows]


def final_distance(run: Run) -> float:
    """True distance [m] of the held object from its packing pose at the end."""
    if not run.iterations.placements.any():
        return NAN
    return float(run.truth[run.held].at(np.array([run.end])).distance_to(run.iterations.p_WT[-1])[0])


def predicted_objects(run: Run) -> float:
    """M_per (Eq. 9): mean number over time of objects in the container that were not seen.

    An estimate without an object says that nothing has seen it so far; it counts as an object not seen.
    """
    windows = {name: track.between(run.start, run.end) for name, track in run.estimate.items()}
    # By time, not by message: a stamp may come twice.
    estimates = {time for window in windows.values() for time in window.times.tolist()}
    if not estimates:
        return NAN
    inside = [windows[name] for name in run.scene.names if name in windows]
    seen = sum(len({*window.times[~window.is_predicted].tolist()}) for window in inside)
    return len(run.scene.names) - seen / len(estimates)


def object_displacements(run: Run) -> dict[str, float]:
    """Distance [m] between where each object in the container stood and where it stands at the end."""
    ends = np.array([run.start, run.end])
    return {name: float(run.truth[name].at(ends).displacement()[-1]) for name in run.scene.names}


def _mean(values: npt.NDArray[Any]) -> float:
    return float(np.mean(values)) if values.size else NAN


def _percentile(values: Array, percent: float) -> float:
    return float(np.percentile(values, percent)) if values.size else NAN


@dataclass(frozen=True)
class Containment:
    """Where the object is at the end, from its true pose and the described sizes.

    Attributes:
        protrusion: how far the object reaches beyond the inner faces of the walls, horizontally and at any
            height, so a part that leans over the rim counts, too [m]; 0: nowhere.
        top_over_rim: height of its highest point above the walls [m]; negative: below.
        centre_over_rim: height of its centre above the walls [m].
        tilt: angle between its z axis and the vertical [rad].
    """

    protrusion: float
    top_over_rim: float
    centre_over_rim: float
    tilt: float

    @property
    def is_contained(self) -> bool:
        """Whether it stands between the walls and its centre is below their rim.

        The paper's condition (section II) with its height threshold h_max at the rim. An object taller than
        the container, as the paper's own, may look out at the top.
        """
        return self.protrusion <= TOLERANCE and self.centre_over_rim < 0.0


def containment(run: Run) -> Containment:
    """Where the held object truly is when the goal ends."""
    X_WO = run.truth[run.held].at(np.array([run.end])).pose(0)
    hull = X_WO.apply(run.scene.new_object.hull())
    container = run.scene.container
    beyond = np.maximum(container.lower - hull[:, :2], hull[:, :2] - container.upper)
    # R[2, 2] is the cosine of the tilt; rounding may take it over 1
    cosine = float(np.clip(to_matrix(X_WO.q)[2, 2], -1.0, 1.0))
    return Containment(
        protrusion=max(0.0, float(beyond.max())),
        top_over_rim=float(hull[:, 2].max()) - container.height,
        centre_over_rim=float(X_WO.p[2]) - container.height,
        tilt=math.acos(cosine),
    )
