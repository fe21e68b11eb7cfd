"""Streams of boxes that are placed online, and what is measured of the pallets."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.paths import config_path
from pack_evaluation.palletizing.shift_studies import STUDIES, ShiftStudy, summarize
from pack_lockstep.palletizing.shift import (
    BoxStreamConfig,
    ShiftBenchmark,
    ShiftSetup,
    StreamJob,
    judged_stack,
    run_stream,
    shift_setup,
    stream_of,
)
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.online_planner import OnlineConfig, OnlinePackerConfig

CELL = palletizing_cell()


def setup(stream: BoxStreamConfig, config: OnlineConfig | None = None) -> ShiftSetup:
    files = [config_path("item_lists", "bed_bpp_00100408.csv")]
    return shift_setup(files, CELL, config or OnlineConfig(), stream, InsertionConfig())


def test_a_stream_is_drawn_from_its_seed_alone_and_every_box_has_its_own_name() -> None:
    given = setup(BoxStreamConfig())
    first, again, other = (
        [item for item, _ in islice(stream_of(given, seed), 50)] for seed in (1000, 1000, 1001)
    )
    assert first == again
    assert first != other
    assert len({item.id for item in first}) == 50


def test_what_boxes_bear_is_that_of_the_stream() -> None:
    given = setup(BoxStreamConfig(max_pressure=2.0, fragile=0.2))
    items = [item for item, _ in islice(stream_of(given, 1000), 500)]
    assert {item.max_pressure for item in items} == {2.0}
    assert np.mean([item.max_load == 0.0 for item in items]) == pytest.approx(0.2, abs=0.05)


def test_a_stream_ends_when_enough_pallets_are_closed_and_its_stacks_hold() -> None:
    # Low stacks of few boxes, so that physics takes a second.
    config = OnlineConfig(packer=OnlinePackerConfig(highest=0.3))
    trial = run_stream(setup(BoxStreamConfig(max_pressure=2.0, fragile=0.2), config), StreamJob(1002))
    assert len(trial["stacks"]) == 2
    assert sum(stack["boxes"] for stack in trial["stacks"]) < trial["came"] <= len(trial["decision_s"])
    for stack in trial["stacks"]:
        assert stack["overloaded"] == 0
        assert stack["push"] >= config.packer.tipping.push - 1e-9
        assert stack["hold_mm"] < 10.0
        assert 0.2 < stack["fill"] <= 1.0


def test_a_stack_that_topples_is_not_held_and_a_box_that_carries_too_much_is_counted() -> None:
    low = PlacedBox("low", np.array([0.4, 0.3, 0.0]), np.array([0.12, 0.4, 0.4]), 5.0, max_load=4.0)
    high = PlacedBox("high", np.array([0.4, 0.3, 0.4]), np.array([0.12, 0.4, 0.4]), 5.0)
    judged = judged_stack([low, high], CELL, 1.0)
    assert judged["push"] == pytest.approx(0.06 / 0.4)
    assert judged["overloaded"] == 1
    assert judged["hold_mm"] > 10.0
    assert judged["fill"] == pytest.approx(2 * 0.12 * 0.4 * 0.4 / 0.96)


def trial(*stacks: dict[str, float]) -> dict[str, object]:
    return {
        "name": "s",
        "seed": 0,
        "came": 10,
        "set_aside": 1,
        "rejected": 0,
        "decision_s": [0.01, 0.03],
        "stacks": list(stacks),
    }


def test_the_summary_is_over_all_closed_pallets() -> None:
    full = {"boxes": 5, "fill": 0.6, "push": 0.25, "overloaded": 0, "hold_mm": 1.0}
    empty = {"boxes": 4, "fill": 0.5, "push": 0.3, "overloaded": 2, "hold_mm": 12.0}
    found = summarize(ShiftStudy(name="s", trials=(trial(full, empty), trial(full, full))))
    assert (found["streams"], found["stacks"], found["stacks_held"], found["overloaded"]) == (2, 4, 3, 2)
    assert found["fill"]["mean"] == pytest.approx(57.5)
    assert found["fill_of_streams"]["deviation"] == pytest.approx(2.5)
    assert found["decision_p99_s"] == pytest.approx(0.03)
    assert STUDIES.tables([ShiftStudy(name="s", trials=(trial(full),))])


def test_shifts_in_which_boxes_moved_have_their_throughput_and_faults() -> None:
    moving = {
        "reason": "all boxes came", "duration_s": 300.0, "on_pallets": 36, "over_table": 9,
        "state_s": {"3 grasp": 0.8}, "waits_s": {"a box": 4.0}, "faults": {}, "faulty": 3,
        "faulty_rejected": 3, "falsely_rejected": 1, "skipped": 0, "unwanted_contacts": 2, "drops": 0,
    }  # fmt: skip
    empty = {"came": 40, "set_aside": 2, "rejected": 4, "decision_s": [0.1], "stacks": [], "moving": moving}
    slower = {**empty, "moving": {**moving, "duration_s": 600.0, "state_s": {"3 grasp": 1.0}}}
    found = summarize(ShiftStudy(name="s", trials=(empty, slower)))
    assert found["boxes_per_hour"] == pytest.approx(72 * 3600.0 / 900.0)
    assert (found["set_aside"], found["faulty"], found["false_set_aside"]) == (6, 6, 2)
    assert (found["unwanted_contacts"], found["drops"]) == (4, 0)
    assert found["over_table_share"] == 0.25
    assert found["state_s"]["3 grasp"] == pytest.approx(0.9)
    assert "Boxes moved" in [table.title for table in STUDIES.tables([ShiftStudy(name="s", trials=(empty,))])]


def test_folders_are_told_apart_by_what_was_asked_for() -> None:
    names = {
        ShiftBenchmark(setup(stream, config), ()).folder_name
        for stream in (BoxStreamConfig(), BoxStreamConfig(max_pressure=2.0), BoxStreamConfig(fragile=0.2))
        for config in (OnlineConfig(), OnlineConfig(buffer=0))
    }
    assert len(names) == 6


def test_lists_without_any_box_that_can_be_held_are_refused(tmp_path: Path) -> None:

    path = tmp_path / "anvils.csv"
    path.write_text("article,length,width,height,weight\nanvil,400,400,400,90\n")
    with pytest.raises(ConfigError, match="no box of the lists can be held: box 'anvil"):
        shift_setup([path], CELL, OnlineConfig(), BoxStreamConfig(), InsertionConfig())
