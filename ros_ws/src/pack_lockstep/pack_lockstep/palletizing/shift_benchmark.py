"""The benchmark of shifts in which everything moves: throughput, stacks as they truly stand, faults."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

from pack_core.palletizing.orders.item_list import Item, placed_item
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.shift_journal import WATCHED, EventKind, ShiftEvent, WrittenShift
from pack_evaluation.palletizing.shift_report import shift_report
from pack_lockstep.benchmarking.benchmark import Benchmark, Verdict
from pack_lockstep.palletizing.shift import StreamJob, judged_stack
from pack_lockstep.palletizing.shift_lockstep import ClosedPallet, ShiftLockstep, ShiftRunSetup


def run_moving(setup: ShiftRunSetup, boxes: int, job: StreamJob) -> dict[str, Any]:
    """Run a shift of so many boxes, and measure it; a line of the results file.

    All but the decisions' times depends on nothing but the arguments.
    """
    run = ShiftLockstep(setup, boxes, job.seed).run()
    report = shift_report(WrittenShift({"seed": job.seed, WATCHED: True}, run.events))
    rejected = set(report["rejected"])
    came = {event.box for event in run.events if event.kind is EventKind.CAME}
    faulty = came & set(run.faults)
    return {
        "name": job.name, "seed": job.seed, "came": report["came"], "set_aside": report["set_aside"],
        "rejected": len(rejected), "decision_s": list(run.decisions),
        "stacks": [_judged(setup, pallet, run.events) for pallet in run.pallets if pallet.boxes],
        "moving": {
            "reason": run.reason, "duration_s": report["duration_s"], "on_pallets": report["on_pallets"],
            "over_table": report["handling"].get("table", 0), "state_s": report["state_s"],
            "waits_s": report["waits_s"], "faults": report["faults"],
            "faulty": len(faulty), "faulty_rejected": len(faulty & rejected),
            "falsely_rejected": len(rejected - faulty), "skipped": len(report["skipped"]),
            "unwanted_contacts": len(report["unwanted_contacts"]),
            "drops": len({*report["lost"], *report["fallen"]}),
            "left_hold_mm": [
                _judged(setup, pallet, run.events)["hold_mm"] for pallet in run.left if pallet.boxes
            ],
        },
    }  # fmt: skip


def _judged(setup: ShiftRunSetup, pallet: ClosedPallet, events: tuple[ShiftEvent, ...]) -> dict[str, Any]:
    """What is measured of a pallet: loads by the places of its boxes, and how it holds as it truly stands."""
    stream = setup.stream
    put_down = {event.box: event for event in events if event.kind is EventKind.PUT_DOWN}
    boxes = [_placed(put_down[body.name]) for body in pallet.boxes if body.name in put_down]
    return judged_stack(boxes, stream.cell, stream.config.packer.highest, pallet.boxes)


def _placed(event: ShiftEvent) -> PlacedBox:
    return placed_item(Item.model_validate(event.data["item"]), event.data["lower"], event.data["size"])


@dataclass(frozen=True)
class MovingShiftBenchmark(Benchmark[StreamJob, dict[str, Any]]):
    """Many shifts of so many boxes under one setting."""

    cell: ClassVar[str] = "palletizing"
    studies: ClassVar[str] = "shift_studies"

    setup: ShiftRunSetup
    boxes: int
    jobs: tuple[StreamJob, ...]

    @property
    def folder_name(self) -> str:
        """Name of the results folder, after the setting."""
        return f"{self.cell}_shift_of_{self.boxes}_{self.setup.stream.name.replace(' ', '_')}"

    def settings(self) -> Mapping[str, Any]:
        """The cell's facts, the parameters of planner, cell, shift and arrivals, and the boxes."""
        setup, stream = self.setup, self.setup.stream
        parts = {
            "cell": stream.cell, "config": stream.config, "stream": stream.stream,
            "insertion": stream.insertion, "lockstep": setup.config, "shift": setup.shift,
            "arrivals": setup.arrivals,
        }  # fmt: skip
        return {
            "name": f"{stream.name} {self.boxes} boxes moved", "studies": self.studies, "boxes": self.boxes,
            **{name: part.model_dump(mode="json") for name, part in parts.items()},
            "items": [item.model_dump(mode="json") for item in stream.items],
        }  # fmt: skip

    @property
    def work(self) -> Callable[[StreamJob], dict[str, Any]]:
        """The function that runs a shift."""
        return partial(run_moving, self.setup, self.boxes)

    def keep(self, result: dict[str, Any], folder: Any) -> Mapping[str, Any]:
        """The measures of the shift; it has no files."""
        return result

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """One line: throughput, pallets, what was rejected, contacts and drops, and why it ended."""
        moving, stacks = trial["moving"], trial["stacks"]
        hourly = 3600.0 * moving["on_pallets"] / max(moving["duration_s"], 1e-9)
        text = (
            f"{moving['on_pallets']} of {trial['came']} boxes  {hourly:.0f} an hour  {len(stacks)} pallets  "
            f"{trial['rejected']} rejected  {moving['unwanted_contacts']} contacts  {moving['drops']} drops  "
            f"{moving['reason']}"
        )
        is_well = not (moving["unwanted_contacts"] or moving["drops"] or moving["falsely_rejected"])
        is_well = is_well and trial["came"] == self.boxes
        return Verdict(trial["name"], is_well and not any(s["overloaded"] for s in stacks), text)
