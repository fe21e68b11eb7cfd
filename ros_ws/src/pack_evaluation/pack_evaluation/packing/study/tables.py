"""A study's tables as text: one row a study, in the columns of the paper's Tables II and III."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pack_core.packing.exit_reason import PackingExitReason
from pack_evaluation.packing.study.summary import contact_force, exits, failure_metrics, summarize
from pack_evaluation.packing.study.trial import PackingStudy
from pack_evaluation.spread import Spread
from pack_evaluation.table import TextTable

FIXED = (PackingExitReason.FORCE, PackingExitReason.DETACHED, PackingExitReason.TIMEOUT)
"""Exit reasons that have a column even if no trial ended so."""
METRIC_NAMES = {
    "m_pos_mm": "M_pos [mm] (Eq. 7)",
    "m_rot_deg": "M_rot [deg] (Eq. 8)",
    "m_per": "M_per [objects] (Eq. 9)",
    "placements": "placements tried",
    "peak_force_N": "peak force [N]",
}


def tables(studies: Sequence[PackingStudy]) -> tuple[TextTable, ...]:
    """All tables that compare packing studies."""
    return (results(studies), forces(studies), iterations(studies), *map(metrics, studies))


def results(studies: Sequence[PackingStudy]) -> TextTable:
    """Tables II and III: success, exits, execution time, distance, force."""
    counts = [exits(study) for study in studies]
    found = {reason.value for reason in FIXED} | set().union(*counts)
    kinds = [r.value for r in PackingExitReason if r.value in found and r is not PackingExitReason.PLACED]
    rows = []
    for study, count in zip(studies, counts, strict=True):
        s = summarize(study)
        force = s["contact_force_N"]
        rows.append((
            study.name, f"{s['success']}/{s['scenes']}", *(str(count.get(kind, 0)) for kind in kinds),
            _plus_minus(s["execution_time_s"]), _plus_minus(s["distance_cm"]),
            _pm(force["mean_of_trials"], force["deviation_of_trials"]),
        ))  # fmt: skip
    note = (
        "Success is reaching FINE-TUNE; a run that did so and was not placed in time counts under both. "
        "Mean ± standard deviation over trials; the time leaves out what a force stop or a detachment ended."
    )
    head = ("", "success", *(_words(kind) for kind in kinds), "time [s]", "distance [cm]", "force [N]")
    return TextTable("Packing", note, head, tuple(rows))


def forces(studies: Sequence[PackingStudy]) -> TextTable:
    """Contact force over all samples, and its peaks."""
    columns = ("mean", "deviation", "median", "p95", "mean_peak", "max_peak")
    rows = tuple(
        (study.name, *(_number(force[column]) for column in columns))
        for study in studies
        for force in [contact_force(study)]
    )
    note = "Load on the cup less the object's weight, all samples of a study; peaks behind a 5 ms low-pass."
    head = ("", "mean [N]", "deviation", "median", "95 %", "mean peak", "highest peak")
    return TextTable("Contact force", note, head, rows)


def iterations(studies: Sequence[PackingStudy]) -> TextTable:
    """Wall clock of the controller, and how many placements it took."""
    rows = []
    for study in studies:
        s = summarize(study)
        ms, placements = s["iteration_ms"], s["placements"]
        rows.append((
            study.name, *(_number(ms[part], 1) for part in ("mean", "deviation", "median", "p95")),
            _number(placements["mean"]), f"{s['first_attempt']}/{s['scenes']}",
        ))  # fmt: skip
    head = ("", "mean [ms]", "deviation", "median", "95 %", "placements", "packed at the first")
    note = "Wall clock of a controller iteration on the machine that ran it, and placements tried a trial."
    return TextTable("Controller", note, head, tuple(rows))


def metrics(study: PackingStudy) -> TextTable:
    """The failure metrics of section IV-E, of successes against failures."""
    rows = tuple(
        (METRIC_NAMES[name], _pair(item.success), _pair(item.failure), _number(item.auc))
        for name, item in failure_metrics(study).items()
    )
    n, m = len(study.successes), len(study.failures)
    note = f"{n} successes, {m} failures. AUC: probability that a failure measures more; 0.5 tells nothing."
    return TextTable(f"Failure metrics: {study.name}", note, ("", "success", "failure", "AUC"), rows)


def _words(kind: str) -> str:
    return kind.replace("_", " ")


def _pair(item: Spread) -> str:
    return _pm(item.mean, item.deviation)


def _plus_minus(item: dict[str, float | None]) -> str:
    return _pm(item["mean"], item["deviation"])


def _pm(mean: float | None, deviation: float | None) -> str:
    return "-" if mean is None or deviation is None else f"{mean:.2f} ± {deviation:.2f}"


def _number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None or math.isnan(value) else f"{value:.{digits}f}"
