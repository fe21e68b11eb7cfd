"""Tables of many palletizing runs: the measures of every study side by side, and a row an order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

from pack_evaluation.palletizing.from_bag import load_pallet_run
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.summary import OrderTrial, summarize_orders
from pack_evaluation.spread import PARTS, spread_text
from pack_evaluation.study import RECORDINGS, KeptTrials, Study, StudyEvaluator, summaries
from pack_evaluation.table import TextTable

SPREADS = {
    "tracking_position_mm": "tracking, position [mm]",
    "tracking_orientation_deg": "tracking, orientation [deg]",
    "true_position_mm": "true tool off its path [mm]",
    "goal_position_mm": "position at goals [mm]",
    "placed_error_mm": "placed box, position [mm]",
    "expected_error_mm": "the same, as the calibration expects [mm]",
    "placed_angle_deg": "placed box, orientation [deg]",
    "shift_mm": "shift of earlier boxes [mm]",
}
CYCLES = {
    "none_or_flip": "cycle, not set down on the table [s]",
    "table": "cycle, turned on the table [s]",
    "mean": "cycle, all boxes [s]",
    "boxes_per_hour": "boxes an hour",
}

Summary = Mapping[str, Any]


def comparison(summaries: Mapping[str, Summary]) -> TextTable:
    """Table with a column for each study and a row for each measure that one of them has."""
    found = summaries.values()
    rows = [
        ("orders complete with every seed", *(f"{s['orders_complete']} of {s['orders']}" for s in found)),
        ("boxes in place", *(f"{s['boxes_ok']} of {s['boxes']}" for s in found)),
        *(
            (name, *(spread_text(s[key] or {}, 3) for s in found))
            for key, name in SPREADS.items()
            if any(s[key] for s in found)
        ),
        *((name, *(_number(s["cycle_s"][key], 3) for s in found)) for key, name in CYCLES.items()),
        ("stacks that hold 0.2 g", *(_held(s["stack_hold"]) for s in found)),
        ("drops", *(str(s["drops"]) for s in found)),
        ("unwanted contacts over 20 N", *(str(s["unwanted_contacts"]) for s in found)),
        ("visitors", *(_visitors(s["visitors"]) for s in found)),
    ]
    note = f"Three numbers in a cell are {', '.join(PARTS.values())}."
    return TextTable("Orders", note, ("", *summaries), tuple(rows))


def states(name: str, summary: Summary) -> TextTable:
    """Table with a row for each state: how long it takes, and how fast the tool is in it."""
    head = ("state", "visits", "mean [s]", "share of all time", "tool, highest [m/s]")
    rows = tuple(
        (label, str(s["visits"]), f"{s['mean_s']:.2f}", f"{s['share']:.1%}", f"{s['peak_mps']:.2f}")
        for label, s in summary["states"].items()
        if s["share"] > 0.0
    )
    return TextTable(f"States: {name}", "States that take no time are left out.", head, rows)


def orders(name: str, summary: Summary) -> TextTable:
    """Table with a row for each order, over all its seeds."""
    head = ("order", "complete", "boxes", "error [mm]", "cycle [s]", "tracking, largest [mm]", "faults")
    rows = tuple(
        (
            order, f"{s['complete']} of {s['runs']}", f"{s['boxes_ok']} of {s['boxes']}",
            spread_text(s["error_mm"]), _number(s["cycle_s"]), _number(s["tracking_mm"]["max"]),
            "; ".join(s["faults"]),
        )
        for order, s in summary["per_order"].items()
    )  # fmt: skip
    note = f"Errors of placed boxes: {', '.join(PARTS.values())}; cycles are means over the boxes placed."
    return TextTable(f"Every order: {name}", note, head, rows)


def _visitors(found: Mapping[str, Any] | None) -> str:
    if found is None:
        return "-"
    return (
        f"{found['crossings']} crossings, nearest {_number(found['least_m'])} m, {found['touches']} contacts"
    )


def _held(hold: Mapping[str, int]) -> str:
    return f"{hold['held']} of {hold['tested']}" if hold["tested"] else "-"


def _number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


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
