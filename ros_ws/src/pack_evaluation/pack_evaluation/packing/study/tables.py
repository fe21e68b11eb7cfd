"""A study's tables as text: one row a study, in the columns of the paper's Tables II and III."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.measures import CYCLE_MS
from pack_evaluation.packing.study.summary import exits, failure_metrics, summarize
from pack_evaluation.packing.study.trial import PackingStudy
from pack_evaluation.spread import Spread
from pack_evaluation.table import TextTable

FIXED = (PackingExitReason.FORCE, PackingExitReason.DETACHED, PackingExitReason.TIMEOUT)
"""Exit reasons that have a column even if no trial ended so."""
METRIC_NAMES = {
    "m_pos_mm": "M_pos [mm] (Eq. 7)",
    "m_rot_deg": "M_rot [deg] (Eq. 8)",
    "m_per": "M_per [objects] (Eq. 9)",
    "grip_error_mm": "grip error [mm]",
    "perception_error_mm": "perception error [mm]",
    "perception_error_deg": "perception error, held [deg]",
    "placements": "placements tried",
    "peak_force_N": "peak force [N]",
}


def tables(studies: Sequence[PackingStudy]) -> tuple[TextTable, ...]:
    """All tables that compare packing studies."""
    return (
        results(studies), ends(studies), forces(studies), iterations(studies), *map(metrics, studies),
    )  # fmt: skip


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


def ends(studies: Sequence[PackingStudy]) -> TextTable:
    """Where the objects end: the paper's condition of section II beside its count of successes."""
    rows = []
    for study in studies:
        s = summarize(study)
        end = s["containment"]
        rows.append((
            study.name, f"{end['contained']}/{s['scenes']}",
            f"{end['packed_and_contained']}/{s['success']}",
            _plus_minus(end["protrusion_mm"]), _number(end["protrusion_mm"]["p95"]),
            _number(end["max_protrusion_mm"]), _plus_minus(end["tilt_deg"]),
            _number(end["tilt_deg"]["p95"]),
        ))  # fmt: skip
    note = (
        "Contained: at the end the object is between the walls, to 3 mm, and its centre below their rim. "
        "Protrusion is how far it truly reaches beyond their inner faces, at any height."
    )
    head = (
        "", "contained", "of the packed", "protrusion [mm]", "95 %", "largest", "tilt [deg]", "95 %",
    )  # fmt: skip
    return TextTable("Containment", note, head, tuple(rows))


def forces(studies: Sequence[PackingStudy]) -> TextTable:
    """Contact force over all samples, its peaks, and how often it jumps."""
    columns = ("mean", "deviation", "median", "p95", "mean_peak", "max_peak")
    rows = []
    for study in studies:
        s = summarize(study)
        force, shares = s["contact_force_N"], s["chatter_percent"]
        rows.append((study.name, *(_number(force[column]) for column in columns), _number(shares["mean"], 1)))
    note = (
        "Load on the cup less the object's weight, all samples of a study; peaks behind a 5 ms low-pass. "
        "Chatter: share of samples in contact that differ by over 5 N from the one 8 ms before, mean over "
        "trials."
    )
    head = ("", "mean [N]", "deviation", "median", "95 %", "mean peak", "highest peak", "chatter [%]")
    return TextTable("Contact force", note, head, tuple(rows))


def iterations(studies: Sequence[PackingStudy]) -> TextTable:
    """Wall clock of the controller, and how many placements it took."""
    rows = []
    for study in studies:
        s = summarize(study)
        ms, late, placements = s["iteration_ms"], s["late_iterations_percent"], s["placements"]
        rows.append((
            study.name, *(_number(ms[part], 1) for part in ("mean", "deviation", "median", "p95")),
            *(_number(share, 1) for share in late.values()),
            _number(placements["mean"]), f"{s['first_attempt']}/{s['scenes']}",
        ))  # fmt: skip
    over = (f"over {limit:.0f} ms [%]" for limit in (CYCLE_MS, 2 * CYCLE_MS))
    head = ("", "mean [ms]", "deviation", "median", "95 %", *over, "placements", "packed at the first")
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
