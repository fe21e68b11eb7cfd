"""A shift as geometry: streams of boxes that come in a sequence nobody knows, placed online on open pallets.

No arm moves. Every decision is the online planner's; the pallets that it closes are judged by the closed
rules of tipping and load-bearing, and pushed in physics.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.box_stream import box_stream, listed_items
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.next_place import NextStep
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.tipping import pushes_of
from pack_core.rotations import Pose
from pack_lockstep.benchmarking.benchmark import Benchmark, Verdict
from pack_lockstep.palletizing.stack_hold import hold_shift_mm, standing
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.online_packer import Turns, warm_up
from pack_planner.layout.online_planner import (
    Floor,
    OnlineConfig,
    OnlinePlanner,
    OpenPallet,
    carried_out,
)
from pack_planner.layout.order_proposal import possible_turns
from pack_planner.layout.place_reach import PlaceReach


class BoxStreamConfig(Config):
    """What comes, and for how long."""

    pallets: PositiveInt = Field(2, description="a stream ends when so many are closed")
    max_pressure: PositiveFloat | None = Field(None, description="on any box's top [kPa]; none: as listed")
    fragile: float = Field(0.0, ge=0, le=1, description="share of boxes on which nothing may stand")


@dataclass(frozen=True)
class ShiftSetup:
    """All settings that decide the results, besides the seeds.

    Attributes:
        cell: the cell's physical facts.
        config: parameters of the planner.
        stream: what comes.
        insertion: how the side is chosen from which a box comes.
        items: the boxes from which streams are drawn; all of them can be held.
        turns: the turns that each may be given, by its id.
    """

    cell: PalletizingCell
    config: OnlineConfig
    stream: BoxStreamConfig
    insertion: InsertionConfig
    items: tuple[Item, ...]
    turns: Turns

    @property
    def name(self) -> str:
        """Short name for tables: rule, open pallets, buffer and preview, tipping, and what boxes bear."""
        config, stream = self.config, self.stream
        words = [
            config.packer.rule, f"{config.pallets} open", f"buffer {config.buffer}",
            f"preview {config.preview}", f"{config.packer.tipping.push:g} g",
            *([f"{stream.max_pressure:g} kPa"] if stream.max_pressure else []),
            *([f"{stream.fragile:.0%} bear nothing"] if stream.fragile else []),
        ]  # fmt: skip
        return " ".join(words).replace("%", " percent")


def shift_setup(
    files: Sequence[Path], cell: PalletizingCell, config: OnlineConfig, stream: BoxStreamConfig,
    insertion: InsertionConfig,
) -> ShiftSetup:  # fmt: skip
    """The settings of streams that are drawn from the boxes of lists in millimetres.

    Raises:
        ConfigError: the cell can hold none of the boxes.
    """
    items = listed_items(files)
    turns, refusals = possible_turns(items, cell)
    held = tuple(item for item in items if turns[item.id])
    if not held:
        raise ConfigError("no box of the lists can be held: " + "; ".join(refusals))
    return ShiftSetup(cell, config, stream, insertion, held, turns)


@dataclass(frozen=True)
class StreamJob:
    """A stream by its seed."""

    seed: int

    @property
    def name(self) -> str:
        """Name of the trial, unique in the benchmark."""
        return f"stream_{self.seed}"


def stream_of(setup: ShiftSetup, seed: int) -> Iterator[tuple[Item, Item]]:
    """The boxes that come under these settings, each with the listed one that it is like."""
    return box_stream(setup.items, seed, setup.stream.max_pressure, setup.stream.fragile)


def run_stream(setup: ShiftSetup, job: StreamJob) -> dict[str, Any]:
    """Place a stream until enough pallets are closed, and judge these; a line of the results file.

    All but the decisions' times depends on nothing but the arguments.
    """
    warm_up()
    reach, turns = PlaceReach(setup.cell, setup.insertion), dict[str, Any]()
    planner = OnlinePlanner(
        setup.cell.pallet.size, turns, setup.config,
        lambda pallet, entry: reach.allows(entry.placed, pallet.boxes),
    )  # fmt: skip
    source, floor = stream_of(setup, job.seed), Floor.empty(setup.config.pallets)
    infeed, closed, times, came, steps = (
        list[Item](),
        list[OpenPallet](),
        list[float](),
        0,
        Counter[NextStep](),
    )
    while len(closed) < setup.stream.pallets:
        while len(infeed) < setup.config.preview:
            item, listed = next(source)
            infeed, came = [*infeed, item], came + 1
            turns[item.id] = setup.turns[listed.id]
        started = time.thread_time()
        decision = planner.decide(floor, infeed)
        times.append(time.thread_time() - started)
        if decision.step is NextStep.CLOSE and decision.pallet is not None:
            closed.append(floor.pallets[decision.pallet])
        steps[decision.step] += 1
        floor = carried_out(floor, decision)
        infeed = [item for item in infeed if item is not decision.item]
    stacks = [pallet.boxes for pallet in closed]
    return {
        "name": job.name, "seed": job.seed, "came": came, "set_aside": steps[NextStep.SET_ASIDE],
        "rejected": steps[NextStep.REJECT], "decision_s": times,
        "stacks": [judged_stack(stack, setup.cell, setup.config.packer.highest) for stack in stacks],
    }  # fmt: skip


def judged_stack(
    boxes: Sequence[PlacedBox], cell: PalletizingCell, height: float,
    stands: Mapping[BoxBody, Pose] | None = None,
) -> dict[str, Any]:  # fmt: skip
    """What is measured of a closed pallet.

    Args:
        boxes: what stands on it.
        cell: the cell's physical facts.
        height: up to which boxes may stand [m]; `fill` is the share of the room below that they take up.
        stands: where the boxes truly stand; by default in their places.
    """
    volume = sum(float(np.prod(box.size)) for box in boxes)
    return {
        "boxes": len(boxes), "fill": volume / (float(np.prod(cell.pallet.size)) * height),
        "push": min(pushes_of(boxes).values()), "overloaded": len(overloaded_boxes(boxes)),
        "hold_mm": hold_shift_mm(cell, standing(boxes, cell) if stands is None else stands),
    }  # fmt: skip


@dataclass(frozen=True)
class ShiftBenchmark(Benchmark[StreamJob, dict[str, Any]]):
    """Many streams under one setting."""

    cell: ClassVar[str] = "palletizing"
    studies: ClassVar[str] = "shift_studies"

    setup: ShiftSetup
    jobs: tuple[StreamJob, ...]

    @property
    def folder_name(self) -> str:
        """Name of the results folder, after the setting."""
        return f"{self.cell}_shift_{self.setup.name.replace(' ', '_')}"

    def settings(self) -> Mapping[str, Any]:
        """The cell's facts, the planner's parameters and the boxes."""
        setup = self.setup
        parts = {
            "cell": setup.cell,
            "config": setup.config,
            "stream": setup.stream,
            "insertion": setup.insertion,
        }
        return {
            "name": setup.name, "studies": self.studies,
            **{name: part.model_dump(mode="json") for name, part in parts.items()},
            "items": [item.model_dump(mode="json") for item in setup.items],
        }  # fmt: skip

    @property
    def work(self) -> Callable[[StreamJob], dict[str, Any]]:
        """The function that places a stream."""
        return partial(run_stream, self.setup)

    def keep(self, result: dict[str, Any], folder: Path) -> Mapping[str, Any]:
        """The measures of the stream; it has no files."""
        return result

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """One line: how full the pallets are, how far they shift, and how many boxes were set aside."""
        stacks = trial["stacks"]
        fills = ", ".join(f"{100 * stack['fill']:.0f} %" for stack in stacks)
        shift = max(stack["hold_mm"] for stack in stacks)
        text = f"full {fills}  shift {shift:.1f} mm  {trial['set_aside']} of {trial['came']} set aside"
        return Verdict(trial["name"], all(stack["overloaded"] == 0 for stack in stacks), text)
