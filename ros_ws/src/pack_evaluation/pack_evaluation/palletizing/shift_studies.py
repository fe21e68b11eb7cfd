"""Benchmarks of shifts side by side: how full pallets become online, and whether they hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pack_core.errors import ConfigError
from pack_evaluation.palletizing.summary import HOLD_LIMIT_MM
from pack_evaluation.spread import spread
from pack_evaluation.study import RECORDINGS, KeptTrials, Study, StudyEvaluator
from pack_evaluation.table import Columns, TextTable, optional_number, row_a_study

KEYS = ("name", "seed", "came", "set_aside", "rejected", "decision_s", "stacks")
"""What a kept stream has."""
HOUR = 3600.0
"""In seconds."""
PERCENT = 1e2
"""In a share of 1."""

ShiftStudy = Study[Mapping[str, Any]]
"""Streams under one setting; a trial has `KEYS`."""


def of_benchmark(kept: KeptTrials) -> list[ShiftStudy]:
    """One study: the streams under one setting."""
    kept.require(KEYS)
    return [ShiftStudy(name=kept.settings["name"], origin=kept.origin, trials=tuple(kept.trials))]


def read_recording(path: Path) -> Mapping[str, Any]:
    """No recording has a shift: raises ConfigError."""
    raise ConfigError(
        f"{path}: a recording has no shift; allowed: a folder of `pack benchmark palletizing --shift`"
    )


def summarize(study: ShiftStudy) -> dict[str, Any]:
    """The measures of a study as plain values.

    `fill` is in percent of the room up to the allowed height, over all closed pallets; `fill_of_streams` is
    over the means of the streams. A stack is held if no box shifts by `HOLD_LIMIT_MM` under 0.2 g.
    """
    stacks = [stack for trial in study.trials for stack in trial["stacks"]]
    times = [time for trial in study.trials for time in trial["decision_s"]]
    full = [trial for trial in study.trials if trial["stacks"]]
    means = [PERCENT * float(np.mean([stack["fill"] for stack in trial["stacks"]])) for trial in full]
    fill, streams = spread([PERCENT * stack["fill"] for stack in stacks]), spread(means)
    came = sum(trial["came"] for trial in study.trials)
    moving = [trial["moving"] for trial in study.trials if "moving" in trial]
    return {
        "streams": len(study.trials),
        "fill": {"mean": fill.mean, "deviation": fill.deviation},
        "fill_of_streams": {"mean": streams.mean, "deviation": streams.deviation},
        "stacks": len(stacks),
        "stacks_held": sum(stack["hold_mm"] < HOLD_LIMIT_MM for stack in stacks),
        "largest_shift_mm": max((stack["hold_mm"] for stack in stacks), default=None),
        "least_push": min((stack["push"] for stack in stacks), default=None),
        "overloaded": sum(stack["overloaded"] for stack in stacks),
        "boxes": came,
        "buffered_share": sum(trial["set_aside"] for trial in study.trials) / came if came else None,
        "rejected": sum(trial["rejected"] for trial in study.trials),
        "decisions": len(times),
        "decision_p99_s": float(np.percentile(times, 99)) if times else None,
        **(_moved(moving) if moving else {}),
    }


def _moved(shifts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The measures of shifts in which everything moved.

    `set_aside` counts boxes that something was wrong with and that were rejected, of `faulty` that came;
    `false_set_aside` those with which nothing was wrong. `state_s` is the time in each state a box.
    """

    def total(name: str) -> float:
        return float(sum(shift[name] for shift in shifts))

    boxes, duration = int(total("on_pallets")), total("duration_s")
    states = sorted({state for shift in shifts for state in shift["state_s"]})
    return {
        "on_pallets": boxes,
        "boxes_per_hour": HOUR * boxes / duration if duration else None,
        "over_table_share": total("over_table") / boxes if boxes else None,
        "faulty": int(total("faulty")),
        "set_aside": int(total("faulty_rejected")),
        "false_set_aside": int(total("falsely_rejected")),
        "skipped": int(total("skipped")),
        "unwanted_contacts": int(total("unwanted_contacts")),
        "drops": int(total("drops")),
        "state_s": {
            state: sum(shift["state_s"].get(state, 0.0) * shift["on_pallets"] for shift in shifts) / boxes
            for state in states
        }
        if boxes
        else {},
        "waits_s": {
            cause: sum(shift["waits_s"].get(cause, 0.0) for shift in shifts)
            for cause in sorted({cause for shift in shifts for cause in shift["waits_s"]})
        },
        "ends": [shift["reason"] for shift in shifts],
    }


def tables(studies: Sequence[ShiftStudy]) -> list[TextTable]:
    """One row a study."""
    note = (
        "Full: share of the room up to the allowed height, mean and standard deviation over closed pallets. "
        "Tips at: the least horizontal acceleration that a box withstands by the closed rule."
    )
    columns: Columns = [
        ("streams", lambda s: str(s["streams"])),
        ("full [%]", lambda s: f"{optional_number(s['fill']['mean'], 1)} +- "
                               f"{optional_number(s['fill']['deviation'], 1)}"),
        ("hold 0.2 g", lambda s: f"{s['stacks_held']}/{s['stacks']}"),
        ("largest shift [mm]", lambda s: optional_number(s["largest_shift_mm"], 1)),
        ("tips at [g]", lambda s: optional_number(s["least_push"], 2)),
        ("overloaded", lambda s: str(s["overloaded"])),
        ("set aside [%]", lambda s: optional_number(s["buffered_share"], 1, PERCENT)),
        ("decision, p99 [s]", lambda s: optional_number(s["decision_p99_s"], 3)),
    ]  # fmt: skip
    summaries = {study.name: summarize(study) for study in studies}
    moved = {name: summary for name, summary in summaries.items() if "boxes_per_hour" in summary}
    found = [row_a_study("Shifts", note, columns, summaries)]
    return [*found, row_a_study("Boxes moved", MOVED_NOTE, MOVED, moved)] if moved else found


MOVED_NOTE = "Rejected: faulty boxes that were rejected, and others that were."
MOVED: Columns = [
    ("boxes on pallets", lambda s: str(s["on_pallets"])),
    ("an hour", lambda s: optional_number(s["boxes_per_hour"], 0)),
    ("over table B [%]", lambda s: optional_number(s["over_table_share"], 0, PERCENT)),
    ("rejected, others", lambda s: f"{s['set_aside']}/{s['faulty']}, {s['false_set_aside']}"),
    ("unwanted contacts", lambda s: str(s["unwanted_contacts"])),
    ("drops", lambda s: str(s["drops"])),
]


STUDIES = StudyEvaluator(
    title="Shifts", of_benchmark=of_benchmark, read_recording=read_recording,
    of_recordings=lambda found: ShiftStudy(name=RECORDINGS, trials=tuple(found)), summary=summarize,
    tables=tables,
)  # fmt: skip
"""Measures every stream from what its run kept."""
