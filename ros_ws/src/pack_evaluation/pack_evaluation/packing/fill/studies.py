"""Benchmarks of filled containers side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pack_evaluation.packing.fill.plots import plot_fills
from pack_evaluation.packing.fill.recording import load_fill_run
from pack_evaluation.study import RECORDINGS, KeptTrials, Study, StudyEvaluator
from pack_evaluation.table import TextTable

PERCENT = 1e2
KEYS = ("name", "without_fault", "objects", "given", "base_area", "volume", "durations", "force", "fills")
"""What a kept trial has, one list each."""


@dataclass(frozen=True, kw_only=True)
class FillStudy(Study):
    """Fill jobs under one setting.

    Attributes:
        trials: one mapping for each list, with `KEYS`.
    """

    trials: tuple[Mapping[str, Any], ...]


class FillStudies(StudyEvaluator[FillStudy, Mapping[str, Any]]):
    """Measures every list from what its run kept, or from its recording."""

    title: ClassVar[str] = "Filled containers"

    def of_benchmark(self, kept: KeptTrials) -> list[FillStudy]:
        """One study: the lists of a method under one setting."""
        kept.require(KEYS)
        return [FillStudy(name=kept.settings["name"], origin=kept.origin, trials=tuple(kept.trials))]

    def read_recording(self, path: Path) -> Mapping[str, Any]:
        """The last fill job of a recording as a trial, named by the recording's path."""
        run = load_fill_run(path)
        return {
            "name": str(path), "without_fault": not run.faults, "objects": len(run.truth.inside),
            "given": run.given, "base_area": run.truth.fill.base_area, "volume": run.truth.fill.volume,
            "durations": run.durations, "force": run.force_peak, "fills": run.report["fills"],
        }  # fmt: skip

    def of_recordings(self, recordings: Sequence[Mapping[str, Any]]) -> FillStudy:
        """All recordings as trials."""
        return FillStudy(name=RECORDINGS, trials=tuple(recordings))

    def summary(self, study: FillStudy) -> dict[str, Any]:
        """Counts, and means over lists; shares from 0 to 1, the time a packed object, the largest force."""
        return summarize(study)

    def tables(self, studies: Sequence[FillStudy]) -> Sequence[TextTable]:
        """One row a study, and one row a list."""
        return [_overview(studies), *map(_lists, studies)]

    def figures(self, studies: Sequence[FillStudy], folder: Path) -> list[Path]:
        """Base area over the time of a job."""
        return plot_fills(
            {study.name: [trial["fills"] for trial in study.trials] for study in studies}, folder
        )


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
        "objects": _mean([trial["objects"] for trial in trials]),
        "base_area": _mean([trial["base_area"] for trial in trials]),
        "volume": _mean([trial["volume"] for trial in trials]),
        "time_per_object_s": _mean(durations),
        "contact_force_N": max((trial["force"] for trial in trials), default=None),
    }


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if len(values) else None


def _overview(studies: Sequence[FillStudy]) -> TextTable:
    rows = []
    for study in studies:
        s = summarize(study)
        rows.append((
            study.name, f"{s['without_fault']}/{s['lists']}", _number(s["objects"]),
            _number(s["base_area"], 1, PERCENT), _number(s["volume"], 1, PERCENT),
            _number(s["time_per_object_s"]), _number(s["contact_force_N"], 1),
        ))  # fmt: skip
    head = (
        "",
        "without a fault",
        "objects",
        "base area [%]",
        "volume [%]",
        "time an object [s]",
        "force [N]",
    )
    note = (
        "A fault is an object that was dropped, a force stop, or an object that ends outside the container. "
        "Objects, area and volume are means over lists, the time over packed objects, the force the largest."
    )
    return TextTable("Filled containers", note, head, tuple(rows))


def _lists(study: FillStudy) -> TextTable:
    rows = [
        (
            trial["name"], "yes" if trial["without_fault"] else "no", f"{trial['objects']}/{trial['given']}",
            _number(trial["base_area"], 1, PERCENT), _number(_mean(trial["durations"])),
            _number(trial["force"], 1),
        )
        for trial in study.trials
    ]  # fmt: skip
    head = ("list", "without a fault", "objects", "base area [%]", "time an object [s]", "force [N]")
    return TextTable(f"Lists: {study.name}", "", head, tuple(rows))


def _number(value: float | None, digits: int = 2, factor: float = 1.0) -> str:
    return "-" if value is None else f"{factor * value:.{digits}f}"


STUDIES = FillStudies()
