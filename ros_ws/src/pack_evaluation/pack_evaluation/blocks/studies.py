"""Many rearrangements side by side: planned by several methods, carried out, or recorded with all nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus, from_record
from pack_core.blocks.problem_file import parse_problem
from pack_evaluation.blocks.from_bag import load_blocks_run
from pack_evaluation.blocks.measures import BlocksMeasures, measure
from pack_evaluation.blocks.plan_drawing import write_plan
from pack_evaluation.blocks.study_tables import comparison, instances, recordings
from pack_evaluation.blocks.summary import OF_PLANS, summarize, summarize_recordings
from pack_evaluation.study import RECORDINGS, KeptTrials, Picture, Study, StudyEvaluator
from pack_evaluation.table import TextTable

Trial = Mapping[str, Any]
Recording = tuple[str, BlocksMeasures]
"""A recording's path and what was measured of it."""


@dataclass(frozen=True, kw_only=True)
class BlocksStudy(Study):
    """Instances that one method planned, or recordings; `detail` says which instances, and the budget.

    Attributes:
        trials: lines of a benchmark.
        recordings: runs with all nodes.
    """

    trials: tuple[Trial, ...] = ()
    recordings: tuple[Recording, ...] = ()


class BlocksStudies(StudyEvaluator[BlocksStudy, Recording]):
    """Takes the measures that every trial was kept with; recordings are measured here."""

    title: ClassVar[str] = "Blocks"
    pictures_title: ClassVar[str] = "Plans, step by step"
    pictures_note: ClassVar[str] = (
        "Blue: picked and placed; orange: pushed; green: at its goal; grey: waiting; outlined: goals."
    )

    def of_benchmark(self, kept: KeptTrials) -> list[BlocksStudy]:
        """One study a method."""
        kept.require({"method", "kind", "problem", "execution", *OF_PLANS})
        methods = dict.fromkeys(trial["method"] for trial in kept.trials)
        return [
            BlocksStudy(name=method, detail=_detail(found, kept.settings), origin=kept.origin, trials=found)
            for method in methods
            for found in [tuple(trial for trial in kept.trials if trial["method"] == method)]
        ]

    def read_recording(self, path: Path) -> Recording:
        """The rearrangement of a recording."""
        return str(path), measure(load_blocks_run(path))

    def of_recordings(self, recordings: Sequence[Recording]) -> BlocksStudy:
        """All recordings together."""
        return BlocksStudy(name=RECORDINGS, recordings=tuple(recordings))

    def summary(self, study: BlocksStudy) -> dict[str, Any]:
        """Counts and spreads, of trials or of recordings."""
        if study.recordings:
            return summarize_recordings([measures for _, measures in study.recordings])
        return summarize(study.trials)

    def tables(self, studies: Sequence[BlocksStudy]) -> Sequence[TextTable]:
        """Comparison of the methods, table of instances, table of recordings."""
        planned = [study for study in studies if not study.recordings]
        recorded = [item for study in studies for item in study.recordings]
        found: list[TextTable] = []
        if planned:
            details = dict.fromkeys(study.detail for study in planned)
            title = f"Blocks: {'; '.join(details)}"
            found.append(comparison({study.name: self.summary(study) for study in planned}, title))
            found.append(instances({study.name: study.trials for study in planned}))
        if recorded:
            found.append(recordings(recorded))
        return found

    def pictures(
        self, studies: Sequence[BlocksStudy], folder: Path, *, count: int, videos: int
    ) -> list[Picture]:
        """The plans of each study's first `count` instances; there are no videos of planned instances."""
        target = folder / "plans"
        drawn = []
        for i, study in enumerate(studies, 1):
            for trial in study.trials[:count]:
                target.mkdir(parents=True, exist_ok=True)
                made = Plan(
                    PlanStatus[trial["status"]], from_record(trial["plan"]), trial["lower_bound"],
                    Diagnosis(trial["message"]),
                )  # fmt: skip
                path = target / f"{i}_{trial['name']}.png"
                write_plan(parse_problem(trial["problem"], trial["name"]), made, path)
                drawn.append(Picture(trial["name"], image=path))
        return drawn


def _detail(trials: Sequence[Trial], settings: Mapping[str, Any]) -> str:
    """Which instances, and how long a plan may take."""
    kinds = ", ".join(dict.fromkeys(trial["kind"] for trial in trials))
    return f"{kinds}, {settings['budget']:g} s a plan"


STUDIES = BlocksStudies()
