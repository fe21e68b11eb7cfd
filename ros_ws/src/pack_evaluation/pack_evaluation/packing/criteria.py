"""When a run counts as packed and how it ended, judged from the recording alone (section IV-C)."""

from __future__ import annotations

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track

PACKED_STAGE = "FINE_TUNE"


class Criteria(Config):
    """Conditions under which a goal ends, with the paper's values (section IV-C)."""

    distance: PositiveFloat = Field(default=0.015, description="to the packing pose when placed [m]")
    timeout: PositiveFloat = Field(default=20.0, description="simulated time [s]")
    force: PositiveFloat = Field(default=float("inf"), description="external force that ends a run [N]")


def is_packed(run: Run) -> bool:
    """Whether the third stage was reached, which the paper counts as success."""
    return bool(run.outcome.get("success", False)) or PACKED_STAGE in run.iterations.stages


def exit_reason(run: Run, criteria: Criteria) -> PackingExitReason:
    """How the goal ended: as recorded in its result, else as derived from the recorded motion."""
    if "exit_reason" in run.outcome:
        return PackingExitReason(run.outcome["exit_reason"])
    return judge(run, criteria)


def judge(run: Run, criteria: Criteria) -> PackingExitReason:
    """How the goal ended, derived from the recorded motion alone."""
    iterations = run.iterations
    if not iterations.times.size:
        return PackingExitReason.NO_PLACEMENT
    if run.release_reason:
        return PackingExitReason.DETACHED
    rows = (run.force_times >= run.start) & (run.force_times <= run.end)
    if np.any(run.force[rows] > criteria.force):
        return PackingExitReason.FORCE
    held: Track = run.estimate[run.held].at(np.array([run.end]))
    if iterations.stages[-1] == PACKED_STAGE and held.distance_to(iterations.p_WT[-1])[0] < criteria.distance:
        return PackingExitReason.PLACED
    return (
        PackingExitReason.TIMEOUT if run.end - run.start >= criteria.timeout else PackingExitReason.UNFINISHED
    )
