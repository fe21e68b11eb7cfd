"""Benchmarks of filled containers side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pack_evaluation.figures import write_figures
from pack_evaluation.packing.fill.plots import DPI, draw_fills
from pack_evaluation.packing.fill.recording import load_fill_run
from pack_evaluation.spread import mean
from pack_evaluation.study import RECORDINGS, KeptTrials, Study, StudyEvaluator
from pack_evaluation.table import Columns, TextTable, optional_number, row_a_study, yes_or_no

PERCENT = 1e2
"""In a share of 1."""
KEYS = ("name", "without_fault", "objects", "given", "base_area", "volume", "durations", "force", "fills")
"""What a kept trial has, one list each."""


FillStudy = Study[Mapping[str, Any]]
"""Fill jobs under one setting; a trial has `KEYS`."""


def of_benchmark(kept: KeptTrials) -> list[FillStudy]:
    """One study: the lists of a method under one setting."""
    kept.require(KEYS)
    return [FillStudy(name=kept.settings["name"], origin=kept.origin, trials=tuple(kept.trials))]


def read_recording(path: Path) -> Mapping[str, Any]:
    """The last fill job of a recording as a trial, named by the recording's path."""
    run = load_fill_run(path)
    return {
        "name": str(path), "without_fault": not run.faults, "objects": len(run.packed),
        "given": len(run.given), "base_area": run.truth.fill.base_area, "volume": run.truth.fill.volume,
        "durations": run.durations, "force": run.force_peak, "fills": run.report["fills"],
    }  # fmt: skip


def summarize(study: FillStudy) -> dict[str, Any]:
    """The measures of a study as plain values.

    `objects`, `base_area` and `volume` are means over lists, the shares from 0 to 1; `time_per_object_s` is
    the mean over all packed objects from their hand-over until the arm is free again; `contact_force_N` is
    the largest external force of all.
    """
    trials = study.trials
    durations = [duration for trial in trials for duration in trial["durations"]]
    return {
        "lists": len(trials),
        "without_fault": sum(bool(trial["without_fault"]) for trial in trials),
        **{key: mean([trial[key] for trial in trials]) for key in ("objects", "base_area", "volume")},
        "time_per_object_s": mean(durations),
        "contact_force_N": max((trial["force"] for trial in trials), default=None),
    }


def tables(studies: Sequence[FillStudy]) -> list[TextTable]:
    """One row a study, and one row a list."""
    note = (
        "A fault is an object that was dropped, a force stop, or an object that ends outside the container. "
        "Objects, area and volume are means over lists, the time over packed objects, the force the largest."
    )
    columns: Columns = [
        ("without a fault", lambda s: f"{s['without_fault']}/{s['lists']}"),
        ("objects", lambda s: optional_number(s["objects"])),
        ("base area [%]", lambda s: optional_number(s["base_area"], 1, PERCENT)),
        ("volume [%]", lambda s: optional_number(s["volume"], 1, PERCENT)),
        ("time an object [s]", lambda s: optional_number(s["time_per_object_s"])),
        ("force [N]", lambda s: optional_number(s["contact_force_N"], 1)),
    ]
    found = {study.name: summarize(study) for study in studies}
    return [row_a_study("Filled containers", note, columns, found), *map(_lists, studies)]


def _lists(study: FillStudy) -> TextTable:
    rows = [
        (
            trial["name"], yes_or_no(trial["without_fault"]), f"{trial['objects']}/{trial['given']}",
            optional_number(trial["base_area"], 1, PERCENT), optional_number(mean(trial["durations"])),
            optional_number(trial["force"], 1),
        )
        for trial in study.trials
    ]  # fmt: skip
    head = ("list", "without a fault", "objects", "base area [%]", "time an object [s]", "force [N]")
    return TextTable(f"Lists: {study.name}", "", head, tuple(rows))


def figures(studies: Sequence[FillStudy], folder: Path) -> list[Path]:
    """Base area over the time of a job."""
    jobs = {study.name: [trial["fills"] for trial in study.trials] for study in studies}
    return write_figures({"fill": draw_fills(jobs)}, folder, DPI)


STUDIES = StudyEvaluator(
    title="Filled containers", of_benchmark=of_benchmark, read_recording=read_recording,
    of_recordings=lambda found: FillStudy(name=RECORDINGS, trials=tuple(found)), summary=summarize,
    tables=tables, figures=figures,
)  # fmt: skip
"""Measures every list from what its run kept, or from its recording."""
