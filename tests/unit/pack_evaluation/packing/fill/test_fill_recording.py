"""A recorded fill job is measured by what truly happened, to its end or as far as the recording goes."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box
from pack_core.packing.packing_list import PackingList, handed_over
from pack_evaluation.packing.fill.evaluator import FILL_EVALUATOR
from pack_evaluation.packing.fill.recording import has_fill_job, load_fill_run
from pack_evaluation.packing.fill.studies import STUDIES as FILL_STUDIES
from pack_evaluation.packing.studies import STUDIES
from unit.pack_evaluation.packing.messages import GoalWriter

CELL = packing_cell()
ITEMS = [Box(name=name, shape="box", size=(0.09, 0.06, 0.1), mass=0.3) for name in ("first", "second")]
GIVEN = PackingList(objects=ITEMS)
AREA = 0.09 * 0.06 / float(np.prod(CELL.scene.container.size))
HANDED_OVER = (*CELL.hand_over.centre, 0.05)
PACKED, BESIDE = (0.45, 0.0, 0.05), (0.7, 0.0, 0.05)


def row(name: str, start: float, *, packed: bool = True) -> dict[str, Any]:
    return {
        "name": name, "packed": packed, "reason": "as told", "exit_reason": "placed", "start": start,
        "duration": 0.4, "force_peak": 0.0, "placements": 1, "pose": None, "fault": False,
    }  # fmt: skip


def write_job(folder: Path, *args: Any, **fields: Any) -> None:
    """A recording of one job, see `add_job`."""
    writer = GoalWriter(folder)
    add_job(writer, *args, **fields)
    writer.close()


def add_job(
    writer: GoalWriter, second_at: Sequence[float] = (0.56, 0.0, 0.05), *, is_whole: bool = True,
    dropped: bool = False, begins: float = 0.0, given: PackingList = GIVEN,
) -> None:  # fmt: skip
    """Two objects, half a second each; the force is 12 N in the second half, and 30 N after the job."""
    scene, (first, second) = given.start(CELL), (item.name for item in given.objects)
    told: dict[str, Any] = {"start": begins, "fills": [[begins, 0.0, 0.0]], "objects": []}
    progress = {**told, "time": begins, "stage": "pick", "object": first, "to_come": [second]}
    writer.write(begins, topics.DESCRIPTION, data=scene.to_yaml())
    writer.write(begins, topics.FILL_PROGRESS, data=json.dumps(progress))
    for k in range(120):
        time = begins + 0.01 * k
        places: Mapping[str, Sequence[float]] = {first: HANDED_OVER if k < 40 else PACKED}
        if k == 50:
            scene = scene.with_next(handed_over(given.objects[1], CELL), keep=True)
            writer.write(time, topics.DESCRIPTION, data=scene.description().to_yaml())
            told["objects"], told["fills"] = [row(first, begins)], [*told["fills"], [begins + 0.5, AREA, 0.1]]
            news = {**progress, **told, "object": second, "to_come": []}
            writer.write(time, topics.FILL_PROGRESS, data=json.dumps(news))
        if k >= 50:
            places = {first: PACKED, second: HANDED_OVER if k < 90 else second_at}
        writer.write_cell(time, places, 12.0 if 50 <= k <= 100 else 30.0 if k > 100 else 0.0)
        if k == 100 and is_whole:
            rows = [row(first, begins), row(second, begins + 0.5) | {"fault": dropped}]
            fills = [*told["fills"], [begins + 1.0, 2 * AREA, 0.2]]
            result = {**told, "objects": rows, "fills": fills, "exit_reason": "done", "message": "as told"}
            writer.write(time, topics.FILL_RESULT, data=json.dumps(result | {"force_peak": 12.0}))


def test_measures_are_what_truly_happened_until_the_job_ended(tmp_path: Path) -> None:
    write_job(tmp_path)
    measures = FILL_EVALUATOR.measure(load_fill_run(tmp_path))
    assert measures.success
    assert (measures.packed, measures.given, measures.faults) == (2, 2, 0)
    assert measures.base_area == pytest.approx(2 * AREA)
    assert measures.time_per_object == pytest.approx(0.4)
    assert measures.force_peak == 12.0


def test_an_object_that_lies_elsewhere_is_a_fault_whatever_the_job_has_seen(tmp_path: Path) -> None:
    write_job(tmp_path, BESIDE)
    run = load_fill_run(tmp_path)
    measures = FILL_EVALUATOR.measure(run)
    assert run.truth.outside == ("second",)
    assert (measures.packed, measures.faults) == (1, 1)
    assert measures.base_area == pytest.approx(AREA)
    assert not measures.success


def test_an_object_back_at_its_hand_over_is_none(tmp_path: Path) -> None:
    write_job(tmp_path, HANDED_OVER)
    run = load_fill_run(tmp_path)
    assert run.truth.outside == ()
    assert run.truth.inside == ("first",)
    assert run.faults == []


def test_a_job_without_a_result_is_measured_as_far_as_its_recording_goes(tmp_path: Path) -> None:
    write_job(tmp_path, is_whole=False)
    assert has_fill_job(tmp_path)
    run = load_fill_run(tmp_path)
    assert run.report["message"] == "the recording ends before the job"
    assert [r["name"] for r in run.report["objects"]] == ["first"]
    measures = FILL_EVALUATOR.measure(run)
    assert measures.given == 2
    assert measures.force_peak == pytest.approx(30.0, rel=0.02)


def test_what_was_still_to_come_when_a_job_ended_is_not_packed(tmp_path: Path) -> None:
    writer, scene = GoalWriter(tmp_path), GIVEN.start(CELL)
    told: dict[str, Any] = {"start": 0.0, "fills": [[0.0, 0.0, 0.0]], "objects": []}
    progress = {**told, "time": 0.0, "stage": "pick", "object": "first", "to_come": ["second"]}
    writer.write(0.0, topics.DESCRIPTION, data=scene.to_yaml())
    writer.write(0.0, topics.FILL_PROGRESS, data=json.dumps(progress))
    for k in range(50):
        writer.write_cell(0.01 * k, {"first": HANDED_OVER if k < 40 else PACKED}, 0.0)
    told |= {"objects": [row("first", 0.0)], "fills": [*told["fills"], [0.49, AREA, 0.1]]}
    result = {**told, "exit_reason": "cancelled", "message": "cancelled", "force_peak": 0.0}
    writer.write(0.49, topics.FILL_RESULT, data=json.dumps(result))
    writer.close()
    measures = FILL_EVALUATOR.measure(load_fill_run(tmp_path))
    assert (measures.packed, measures.given, measures.success) == (1, 2, False)


def test_a_job_in_a_container_that_is_not_empty_has_packed_its_own_objects_only(tmp_path: Path) -> None:
    """What stood there before fills the container, but was not given."""
    writer, (first, second) = GoalWriter(tmp_path), ITEMS
    add_job(writer)
    scene = GIVEN.start(CELL).with_next(handed_over(second, CELL), keep=True)
    third = first.model_copy(update={"name": "third"})
    scene = scene.with_next(handed_over(third, CELL), keep=True)
    told: dict[str, Any] = {"start": 2.0, "fills": [[2.0, 2 * AREA, 0.2]], "objects": []}
    there = {"first": PACKED, "second": (0.56, 0.0, 0.05)}
    for k in range(50):
        if k == 10:
            writer.write(2.1, topics.DESCRIPTION, data=scene.description().to_yaml())
        writer.write_cell(2.0 + 0.01 * k, there | ({"third": HANDED_OVER} if k >= 10 else {}), 0.0)
    result = {**told, "objects": [row("third", 2.1, packed=False)], "fills": [[2.49, 2 * AREA, 0.2]]}
    result |= {"exit_reason": "done", "message": "0 of 1 objects packed", "force_peak": 0.0}
    writer.write(2.49, topics.FILL_RESULT, data=json.dumps(result))
    writer.close()
    measures = FILL_EVALUATOR.measure(load_fill_run(tmp_path))
    assert (measures.packed, measures.given, measures.success) == (0, 1, False)
    assert measures.base_area == pytest.approx(2 * AREA)


def test_of_two_jobs_in_one_recording_the_last_is_measured(tmp_path: Path) -> None:
    items = [item.model_copy(update={"name": f"other_{item.name}"}) for item in ITEMS]
    writer = GoalWriter(tmp_path)
    add_job(writer, BESIDE)
    add_job(writer, begins=2.0, given=PackingList(objects=items))
    writer.close()
    run = load_fill_run(tmp_path)
    measures = FILL_EVALUATOR.measure(run)
    assert (measures.packed, measures.given, measures.faults) == (2, 2, 0)
    assert measures.success
    assert measures.base_area == pytest.approx(2 * AREA)
    assert set(run.truth.inside) == {item.name for item in items}


def test_several_recordings_are_lists_of_one_study(tmp_path: Path) -> None:
    write_job(tmp_path / "a")
    write_job(tmp_path / "b", dropped=True)
    folders = [tmp_path / "a", tmp_path / "b"]
    assert {STUDIES.kind_of(folder) for folder in folders} == {"fill_studies"}
    study = FILL_STUDIES.of_recordings([FILL_STUDIES.read_recording(folder) for folder in folders])
    summary = FILL_STUDIES.summary(study)
    assert (summary["lists"], summary["without_fault"], summary["objects"]) == (2, 1, 2.0)
    assert summary["base_area"] == pytest.approx(2 * AREA)


def test_a_recording_of_a_packing_goal_has_no_fill_job(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path)
    writer.write_goal(0.0, {"exit_reason": "placed", "success": True, "message": "", "execution_time": 1.0})
    writer.close()
    assert not has_fill_job(tmp_path)
    assert STUDIES.kind_of(tmp_path) == "studies"
    with pytest.raises(BagError, match="/fill_container/result"):
        load_fill_run(tmp_path)
