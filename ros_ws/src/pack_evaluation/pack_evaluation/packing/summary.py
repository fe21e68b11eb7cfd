"""The statistics of many packing runs as plain values."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pack_core.packing.goals import PackingExitReason
from pack_core.rotations import Array
from pack_evaluation.packing.measures import CYCLE_MS, PackingMeasures, goal_force, measure
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.seen_objects import PerceptionErrors, figures, perception_errors
from pack_evaluation.spread import Split, split, spread
from pack_evaluation.study import Study

EARLY = (PackingExitReason.FORCE, PackingExitReason.DETACHED)
"""Exits whose execution time the paper does not count (section IV-C)."""


@dataclass(frozen=True)
class PackingTrial:
    """One run, measured.

    Attributes:
        name: name of the scene or the recording.
        measures: the run's measures.
        message: how it ended, in words.
        forces: force samples during the goal `(n,)` [N].
        iterations_ms: wall clock time of every controller iteration `(N,)` [ms].
        perception: errors of perception by depth images; None with markers.
    """

    name: str
    measures: PackingMeasures
    message: str
    forces: Array
    iterations_ms: Array
    perception: PerceptionErrors | None = None

    @property
    def ended_early(self) -> bool:
        """Whether a force stop or a detachment cut the run short."""
        return self.measures.exit_reason in EARLY


def trial_of(name: str, run: Run) -> PackingTrial:
    """Measure a run as part of a study."""
    message = str(run.outcome.get("message", ""))
    return PackingTrial(
        name, measure(run), message, goal_force(run)[1], run.iterations.ms, perception_errors(run)
    )


@dataclass(frozen=True, kw_only=True)
class PackingStudy(Study[PackingTrial]):
    """Trials of one method under one setting, a row of the paper's tables.

    Attributes:
        load: reads a trial's run again, by the trial's name, to draw it.
    """

    load: Callable[[str], Run] | None = None

    @property
    def successes(self) -> tuple[PackingTrial, ...]:
        """Trials that reached FINE-TUNE."""
        return tuple(trial for trial in self.trials if trial.measures.success)

    @property
    def failures(self) -> tuple[PackingTrial, ...]:
        """Trials that did not reach FINE-TUNE."""
        return tuple(trial for trial in self.trials if not trial.measures.success)


Metric = Callable[[PackingMeasures], float]

FAILURE_METRICS: dict[str, Metric] = {
    "m_pos_mm": lambda m: 1e3 * m.m_pos,
    "m_rot_deg": lambda m: math.degrees(m.m_rot),
    "m_per": lambda m: m.m_per,
    "grip_error_mm": lambda m: 1e3 * m.grip_error,
    "perception_error_mm": lambda m: 1e3 * m.perception_error,
    "perception_error_deg": lambda m: math.degrees(m.perception_angle),
    "placements": lambda m: float(m.placements),
    "peak_force_N": lambda m: m.force_peak,
}
"""What is compared between successes and failures; the first three are Eqs. 7 to 9 (section IV-E)."""


def summarize(study: PackingStudy) -> dict[str, Any]:
    """Counts, the spread of every measure, and the failures by name."""
    measures = [trial.measures for trial in study.trials]
    return {
        "scenes": len(measures),
        "success": len(study.successes),
        "first_attempt": sum(m.placements == 1 for m in (t.measures for t in study.successes)),
        "exits": exits(study),
        "execution_time_s": asdict(
            spread([t.measures.execution_time for t in study.trials if not t.ended_early])
        ),
        "distance_cm": asdict(spread([1e2 * m.distance for m in measures])),
        "containment": containment(study),
        "contact_force_N": contact_force(study),
        "chatter_percent": asdict(spread([1e2 * m.chatter for m in measures])),
        "iteration_ms": asdict(spread(_pooled([trial.iterations_ms for trial in study.trials]))),
        "late_iterations_percent": late_iterations(study),
        "real_time_factor": asdict(spread([m.real_time_factor for m in measures])),
        "placements": asdict(spread([float(m.placements) for m in measures])),
        "displacement_cm": asdict(spread([1e2 * m.displacement for m in measures])),
        "failure_metrics": {name: item.to_json() for name, item in failure_metrics(study).items()},
        "failures": [
            {"scene": trial.name, "exit": trial.measures.exit_reason.value, "message": trial.message}
            for trial in study.failures
        ],
        **perception(study),
        **study.about,
    }


def perception(study: PackingStudy) -> dict[str, Any]:
    """The figures of perception by depth images, below `perception`; nothing where objects carry markers."""
    errors = [trial.perception for trial in study.trials if trial.perception is not None]
    return {"perception": figures(errors)} if errors else {}


def exits(study: PackingStudy) -> dict[str, int]:
    """How many trials ended in each way, in the order of `PackingExitReason`."""
    counts = Counter(trial.measures.exit_reason for trial in study.trials)
    return {reason.value: counts[reason] for reason in PackingExitReason if counts[reason]}


def contact_force(study: PackingStudy) -> dict[str, float | None]:
    """Spread over all samples of all trials [N], and over trials their means and their peaks."""
    means = spread([trial.measures.force_mean for trial in study.trials])
    peaks = [trial.measures.force_peak for trial in study.trials]
    return {
        **asdict(spread(_pooled([trial.forces for trial in study.trials]))),
        "mean_of_trials": means.mean,
        "deviation_of_trials": means.deviation,
        "mean_peak": spread(peaks).mean,
        "max_peak": max((peak for peak in peaks if not math.isnan(peak)), default=None),
    }


def containment(study: PackingStudy) -> dict[str, Any]:
    """How many objects end inside the container, and the spread of where the objects of all trials end."""
    measures = [trial.measures for trial in study.trials]
    return {
        "contained": sum(m.is_contained for m in measures),
        "packed_and_contained": sum(trial.measures.is_contained for trial in study.successes),
        "protrusion_mm": asdict(spread([1e3 * m.protrusion for m in measures])),
        "max_protrusion_mm": max((1e3 * m.protrusion for m in measures), default=None),
        "top_over_rim_cm": asdict(spread([1e2 * m.top_over_rim for m in measures])),
        "tilt_deg": asdict(spread([math.degrees(m.tilt) for m in measures])),
    }


def late_iterations(study: PackingStudy) -> dict[str, float | None]:
    """Shares [%] of the iterations of all trials that took over one cycle of the controller, and over two."""
    ms = _pooled([trial.iterations_ms for trial in study.trials])
    return {
        f"over_{limit:.0f}_ms": 1e2 * float(np.mean(ms > limit)) if ms.size else None
        for limit in (CYCLE_MS, 2 * CYCLE_MS)
    }


def failure_metrics(study: PackingStudy) -> dict[str, Split]:
    """Eqs. 7 to 9 and their companions, of successes against failures."""
    return {
        name: split(
            [metric(trial.measures) for trial in study.successes],
            [metric(trial.measures) for trial in study.failures],
        )
        for name, metric in FAILURE_METRICS.items()
    }


def _pooled(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(parts) if parts else np.empty(0)
