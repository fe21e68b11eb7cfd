"""Tables of many rearrangements: planning methods side by side, every instance, every recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pack_evaluation.blocks.measures import BlocksMeasures
from pack_evaluation.blocks.summary import OF_EXECUTIONS, OF_PLANS
from pack_evaluation.spread import PARTS, spread_text
from pack_evaluation.table import TextTable, measure_rows

COUNTS = {
    "solved": ("solved", "instances"),
    "plans accepted by the verifier": ("verified", "solved"),
    "as short as the lower bound": ("at_lower_bound", "solved"),
    "carried out well": ("executed_ok", "executed"),
}
"""Rows of counts: name of the row, key of the count, key of the total."""


def comparison(summaries: Mapping[str, Mapping[str, Any]], title: str) -> TextTable:
    """Table with a column for each study and a row for each measure that a study has."""
    found = summaries.values()
    lines = [
        (name, *(f"{s[part]} of {s[whole]}" for s in found))
        for name, (part, whole) in COUNTS.items()
        if any(s[whole] for s in found)
    ]
    lines += [
        (name, *(spread_text(s[key]) for s in found))
        for key, name in (OF_PLANS | OF_EXECUTIONS).items()
        if any(s[key]["mean"] is not None for s in found)
    ]
    note = f"Of every measure: {', '.join(PARTS.values())}; those of plans over the instances solved."
    return TextTable(title, note, ("", *summaries), tuple(lines))


def instances(trials: Mapping[str, Sequence[Mapping[str, Any]]]) -> TextTable:
    """Table with a row for each instance and a column for each study.

    Args:
        trials: the trials of every study, by its name.
    """
    by_name = {(name, t["instance"]): t for name, found in trials.items() for t in found}
    known = dict.fromkeys(t["instance"] for found in trials.values() for t in found)
    lines = tuple((item, *(_outcome(by_name.get((name, item))) for name in trials)) for item in known)
    note = "Status, actions (lower bound), milliseconds to the first plan."
    return TextTable("Instances", note, ("instance", *trials), lines)


def recordings(measured: Sequence[tuple[str, BlocksMeasures]]) -> TextTable:
    """Table with a row for each measure and a column for each recording."""
    by_recording = [{row.name: row.value for row in measure_rows(measures)} for _, measures in measured]
    names = dict.fromkeys(name for values in by_recording for name in values)
    lines = tuple((name, *(values.get(name, "-") for values in by_recording)) for name in names)
    return TextTable("Recordings", "Every run with all nodes.", ("", *(name for name, _ in measured)), lines)


def _outcome(trial: Mapping[str, Any] | None) -> str:
    if trial is None:
        return ""
    if not trial["is_solved"]:
        return f"{trial['status']}: {trial['message']}"
    text = f"{trial['status']}, {trial['actions']} ({trial['lower_bound']}), {trial['first_plan_ms']:.1f} ms"
    return "; ".join([text, *trial["faults"]])
