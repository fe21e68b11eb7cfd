"""Recordings of the blocks cell."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pack_core.blocks import topics
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import BlockSize, Problem
from pack_core.blocks.problem_file import load_problem, parse_problem
from pack_core.errors import BagError
from pack_core.motion.topics import JOINT_STATES
from pack_core.paths import config_path
from pack_core.robots.ur10e import JOINTS
from pack_evaluation.blocks import evaluator
from pack_evaluation.blocks.from_bag import FIELDS, PROBLEM_FILE, load_blocks_run, problem_of, read_result
from pack_evaluation.blocks.measures import measure
from pack_evaluation.goals import GoalNumber
from pack_evaluation.table import measure_rows
from unit.pack_evaluation.packing.messages import header, make, pose, write_bag

EXAMPLE = config_path("scenarios", "blocks", "example.yaml")


def test_a_result_of_another_version_is_refused_by_name() -> None:
    result = dict.fromkeys(FIELDS, 0)
    assert read_result(json.dumps(result), Path("bag")) == result
    del result["refusals"]
    with pytest.raises(BagError, match="bag: the result lacks refusals"):
        read_result(json.dumps(result), Path("bag"))


def test_the_problem_comes_with_the_result_whatever_lies_beside_the_bag(tmp_path: Path) -> None:
    text = EXAMPLE.read_text()
    (tmp_path / PROBLEM_FILE).write_text("of another goal")
    assert problem_of({"problem": text}, tmp_path) == parse_problem(text, "example")


def test_the_problem_of_an_older_recording_lies_in_a_file_beside_it(tmp_path: Path) -> None:
    (tmp_path / PROBLEM_FILE).write_text(EXAMPLE.read_text())
    for path in (tmp_path, tmp_path / "bag"):
        assert problem_of({}, path) == load_problem(EXAMPLE)


def a_goal(start: float, lateness: float = 0.0) -> list[tuple[float, str, Any]]:
    """One second, after half of which every block is at its goal, less `lateness` [m] along x."""
    problem, found = load_problem(EXAMPLE), []
    status = make(
        "pack_interfaces/msg/RearrangeStatus", header=header(start), plans=1, lower_bound=4,
        plan=[make("pack_interfaces/msg/BlockAction", kind=1, start=block("b1", 0.6), end=block("b1", 0.7))],
    )  # fmt: skip
    found.append((start, topics.STATUS, status))
    for k in range(11):
        time = start + 0.1 * k
        places = problem.starts if k < 5 else problem.goals
        objects = [
            make("pack_interfaces/msg/ObjectState", name=name, pose=pose(at.x - lateness, at.y, 0.0))
            for name, at in places.items()
        ]
        joints = make(
            "sensor_msgs/msg/JointState", header=header(time), name=list(JOINTS), position=np.full(6, time)
        )
        found += [
            (
                time,
                topics.TRUTH,
                make("pack_interfaces/msg/SceneState", header=header(time), objects=objects),
            ),
            (time, JOINT_STATES, joints),
            (time, topics.JAW_STATE, make("pack_interfaces/msg/JawState", header=header(time), opening=0.06)),
        ]
    sighting = make(
        "pack_interfaces/msg/BlockSighting", header=header(start + 0.72), blocks=[block("b1", 0.6774)],
        missing=["b2"],
    )  # fmt: skip
    result = {**dict.fromkeys(FIELDS, 0), "success": True, "exit_reason": "arranged", "picks": 3, "pushes": 1}
    result |= {"message": "all blocks are in place", "execution_time": 1.0, "problem": EXAMPLE.read_text()}
    text = make("std_msgs/msg/String", data=json.dumps(result))
    return [*found, (start + 0.9, topics.BLOCK_POSES, sighting), (start + 1.0, topics.RESULT, text)]


def block(name: str, x: float) -> Any:
    return make("pack_interfaces/msg/BlockPose", id=name, x=x, y=0.0264)


def test_a_recorded_goal_becomes_arrays_and_measures(tmp_path: Path) -> None:
    write_bag(tmp_path, [*a_goal(2.0, lateness=0.001), *a_goal(5.0)])
    run = load_blocks_run(tmp_path, 1)
    assert (run.goal, run.start, run.end) == (GoalNumber(1, 2), 2.0, pytest.approx(3.0))
    assert run.joints[-1] == pytest.approx(np.full(6, 3.0))
    assert run.openings.tolist() == [0.06] * 11
    assert [len(plan.actions) for plan in run.plans] == [1]
    goal = run.problem.goals["b1"]
    assert run.poses_at(2.5)["b1"].distance_to(PlanarPose(goal.x - 0.001, goal.y)) == pytest.approx(0.0)
    measures = measure(run)
    assert measures.error_mm == pytest.approx(dict.fromkeys(run.problem.goals, 1.0))
    assert (measures.actions, measures.planned, measures.lower_bound) == (4, 1, 4)
    assert (measures.pictures, measures.unclear, measures.plans) == (1, 1, 0)
    assert measures.seen_mm[1] == pytest.approx(2.0)
    assert measure(load_blocks_run(tmp_path)).error_mm == pytest.approx(dict.fromkeys(run.problem.goals, 0.0))


def test_plans_are_drawn_with_blocks_as_large_as_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Problem] = []
    monkeypatch.setattr(evaluator, "write_plan", lambda problem, plan, path: drawn.append(problem))
    write_bag(tmp_path, a_goal(2.0))
    run = load_blocks_run(tmp_path)
    first, *others = run.problem.blocks
    large = replace(first, size=BlockSize(0.04, 0.07, 0.05))
    evaluator.draw(replace(run, problem=replace(run.problem, blocks=(large, *others))), tmp_path)
    assert [problem.sizes[first.id] for problem in drawn] == [large.size]


def test_without_pictures_nothing_is_said_of_perception(tmp_path: Path) -> None:
    write_bag(tmp_path, [row for row in a_goal(2.0) if row[1] != topics.BLOCK_POSES])
    rows = {row.name: row.value for row in measure_rows(measure(load_blocks_run(tmp_path)))}
    assert (rows["perceived centre"], rows["perceived yaw"]) == ("-", "-")


def test_a_topic_that_nobody_sent_is_named(tmp_path: Path) -> None:
    write_bag(tmp_path, [row for row in a_goal(2.0) if row[1] != topics.JAW_STATE])
    with pytest.raises(BagError, match=rf"goal 1 of 1 has no message on {topics.JAW_STATE}: was the node"):
        load_blocks_run(tmp_path)
