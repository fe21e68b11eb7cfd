"""Many runs of the palletizing cell side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

from pack_evaluation.palletizing.from_bag import load_pallet_run
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.study_tables import comparison, orders, states
from pack_evaluation.palletizing.summary import OrderTrial, summarize_orders
from pack_evaluation.study import RECORDINGS, KeptTrials, Study, StudyEvaluator, summaries
from pack_evaluation.table import TextTable


@dataclass(frozen=True, kw_only=True)
class PalletStudy(Study):
    """Orders that were built under one setting."""

    trials: tuple[OrderTrial, ...]


class PalletStudies(StudyEvaluator[PalletStudy, OrderTrial]):
    """Takes the measures that every trial was kept with."""

    title: ClassVar[str] = "Palletizing"

    def of_benchmark(self, kept: KeptTrials) -> list[PalletStudy]:
        """One study: the orders under one setting."""
        kept.require({"order", "seed", "measures", "hold_mm"})
        trials = tuple(
            OrderTrial(
                trial["order"], trial["seed"], trial["measures"], trial["hold_mm"], trial.get("predicted_mm")
            )
            for trial in kept.trials
        )
        return [PalletStudy(name=kept.settings["name"], origin=kept.origin, trials=trials)]

    def read_recording(self, path: Path) -> OrderTrial:
        """The order of a recording; its stack is not tested, for that takes a simulation."""
        run = load_pallet_run(path)
        return OrderTrial(run.order, run.seed, asdict(measure_order(run)), None)

    def of_recordings(self, recordings: Sequence[OrderTrial]) -> PalletStudy:
        """All recordings as trials."""
        return PalletStudy(name=RECORDINGS, trials=tuple(recordings))

    def summary(self, study: PalletStudy) -> dict[str, Any]:
        """The figures over all runs of a study."""
        return summarize_orders(study.trials)

    def tables(self, studies: Sequence[PalletStudy]) -> Sequence[TextTable]:
        """The measures side by side, then every order of each study."""
        found = summaries(self, studies)
        return (
            comparison(found),
            *(orders(name, summary) for name, summary in found.items()),
            *(states(name, summary) for name, summary in found.items()),
        )


STUDIES = PalletStudies()
