"""Tables of many palletizing runs: the measures of every study side by side, and a row an order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import starmap
from pathlib import Path
from typing import Any

from pack_evaluation.palletizing.from_bag import load_pallet_run
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.summary import OrderTrial, summarize_orders
from pack_evaluation.spread import PARTS, spread_text
from pack_evaluation.study import RECORDINGS, KeptTrials, Study, StudyEvaluator
from pack_evaluation.table import TextTable, column_a_study, optional_number

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
    spreads = [
        (name, lambda s, key=key: spread_text(s[key] or {}, 3))
        for key, name in SPREADS.items()
        if any(s[key] for s in summaries.values())
    ]
    rows = [
        ("orders complete with every seed", lambda s: f"{s['orders_complete']} of {s['orders']}"),
        ("boxes in place", lambda s: f"{s['boxes_ok']} of {s['boxes']}"),
        *spreads,
        *((name, lambda s, key=key: optional_number(s["cycle_s"][key], 3)) for key, name in CYCLES.items()),
        ("stacks that hold 0.2 g", lambda s: _held(s["stack_hold"])),
        ("drops", lambda s: str(s["drops"])),
        ("unwanted contacts over 20 N", lambda s: str(s["unwanted_contacts"])),
        ("visitors", lambda s: _visitors(s["visitors"])),
    ]
    note = f"Three numbers in a cell are {', '.join(PARTS.values())}."
    return column_a_study("Orders", note, rows, summaries)


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
            spread_text(s["error_mm"]), optional_number(s["cycle_s"]),
            optional_number((s["tracking_mm"] or {"max": None})["max"]), "; ".join(s["faults"]),
        )
        for order, s in summary["per_order"].items()
    )  # fmt: skip
    note = f"Errors of placed boxes: {', '.join(PARTS.values())}; cycles are means over the boxes placed."
    return TextTable(f"Every order: {name}", note, head, rows)


def _visitors(found: Mapping[str, Any] | None) -> str:
    if found is None:
        return "-"
    nearest, margin = optional_number(found["least_m"]), optional_number(found["margin_m"])
    seen = f"{found['crossings']} crossings, nearest {nearest} m, least margin {margin} m"
    return f"{seen}, {found['touches']} contacts"


def _held(hold: Mapping[str, int]) -> str:
    return f"{hold['held']} of {hold['tested']}" if hold["tested"] else "-"


PalletStudy = Study[OrderTrial]
"""Orders that were built under one setting."""


def of_benchmark(kept: KeptTrials) -> list[PalletStudy]:
    """One study: the orders under one setting, with the measures that every trial was kept with."""
    kept.require({"order", "seed", "measures", "hold_mm"})
    trials = tuple(
        OrderTrial(
            trial["order"], trial["seed"], trial["measures"], trial["hold_mm"], trial.get("predicted_mm")
        )
        for trial in kept.trials
    )
    return [PalletStudy(name=kept.settings["name"], origin=kept.origin, trials=trials)]


def read_recording(path: Path) -> OrderTrial:
    """The order of a recording; its stack is not tested, for that takes a simulation."""
    run = load_pallet_run(path)
    return OrderTrial(run.order, run.seed, asdict(measure_order(run)), None)


def tables(studies: Sequence[PalletStudy]) -> list[TextTable]:
    """The measures side by side, then every order of each study, then its states."""
    found = {study.name: summarize_orders(study.trials) for study in studies}
    return [comparison(found), *starmap(orders, found.items()), *starmap(states, found.items())]


STUDIES = StudyEvaluator(
    title="Palletizing", of_benchmark=of_benchmark, read_recording=read_recording,
    of_recordings=lambda found: PalletStudy(name=RECORDINGS, trials=tuple(found)),
    summary=lambda study: summarize_orders(study.trials), tables=tables,
)  # fmt: skip
