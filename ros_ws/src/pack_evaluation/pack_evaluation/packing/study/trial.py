"""One run of a study, and the runs that belong together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pack_core.packing.goals import PackingExitReason
from pack_core.rotations import Array
from pack_evaluation.packing.criteria import Criteria
from pack_evaluation.packing.measures import PackingMeasures, goal_force, measure
from pack_evaluation.packing.run import Run
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
    """

    name: str
    measures: PackingMeasures
    message: str
    forces: Array
    iterations_ms: Array

    @property
    def ended_early(self) -> bool:
        """Whether a force stop or a detachment cut the run short."""
        return self.measures.exit_reason in EARLY


def trial_of(name: str, run: Run, criteria: Criteria | None = None) -> PackingTrial:
    """Measure a run as part of a study."""
    message = str(run.outcome.get("message", ""))
    return PackingTrial(name, measure(run, criteria), message, goal_force(run)[1], run.iterations.ms)


@dataclass(frozen=True, kw_only=True)
class PackingStudy(Study):
    """Trials of one method under one setting, a row of the paper's tables.

    Attributes:
        trials: the runs, measured.
        load: reads a trial's run again, by the trial's name, to draw it.
    """

    trials: tuple[PackingTrial, ...]
    load: Callable[[str], Run] | None = None

    @property
    def successes(self) -> tuple[PackingTrial, ...]:
        """Trials that reached FINE-TUNE."""
        return tuple(trial for trial in self.trials if trial.measures.success)

    @property
    def failures(self) -> tuple[PackingTrial, ...]:
        """Trials that did not reach FINE-TUNE."""
        return tuple(trial for trial in self.trials if not trial.measures.success)
