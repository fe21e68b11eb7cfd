import json
from pathlib import Path

import pytest

from pack_core.errors import BagError
from pack_evaluation.bag import Bag, Recorded
from pack_evaluation.goals import GoalNumber, goal_of, without_earlier_gaps
from pack_evaluation.packing.from_bag import load_run
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter

RESULT, STATE, DESCRIPTION = "/result", "/state", "/description"


def bag_of(*topics: str) -> Bag:
    """A message of each topic, a second apart; its content is its place."""
    messages = tuple(Recorded(topic, 1_000_000_000 * k, k) for k, topic in enumerate(topics))
    return Bag(Path("run"), messages, is_cut=False)


def places(bag: Bag, number: int | None = None, **kwargs: object) -> list[int]:
    found, _ = goal_of(bag, number, result=RESULT, latched=[DESCRIPTION], **kwargs)
    return [item.message for item in found.messages]


TWO = bag_of(DESCRIPTION, STATE, RESULT, STATE, STATE, RESULT, STATE)


def test_a_goal_ends_with_its_result_and_keeps_what_was_latched_before() -> None:
    assert places(TWO, 1) == [0, 1, 2]
    assert places(TWO, 2) == [0, 3, 4, 5, 6]


def test_the_last_goal_is_taken_unless_another_is_asked_for_and_all_are_counted() -> None:
    assert goal_of(TWO, None, result=RESULT)[1] == GoalNumber(2, 2)
    assert places(TWO) == places(TWO, 2)


def test_a_goal_that_has_begun_and_not_ended_counts() -> None:
    assert places(TWO, 3, has_begun=bool) == [0, 6]


def test_a_result_from_before_the_recording_is_no_goal() -> None:
    bag = bag_of(DESCRIPTION, RESULT, STATE, RESULT)
    assert goal_of(bag, None, result=RESULT, latched=[DESCRIPTION])[1] == GoalNumber(1, 1)
    assert places(bag) == [0, 2, 3]


def test_a_recording_without_any_result_is_one_goal() -> None:
    assert places(bag_of(DESCRIPTION, STATE)) == [0, 1]


@pytest.mark.parametrize("number", [0, 3])
def test_a_goal_that_is_not_there_is_refused_with_how_many_there_are(number: int) -> None:
    with pytest.raises(BagError, match=f"no goal {number}; it holds 2"):
        goal_of(TWO, number, result=RESULT)


def test_what_lies_before_a_pause_of_the_recording_is_left_out_but_for_what_is_latched() -> None:
    times = [0.0, 0.1, 9.8, 9.9, 10.0, 12.0]  # a pause before the goal, which begins at 10 s, and one in it
    topics = [DESCRIPTION, STATE, STATE, STATE, STATE, RESULT]
    messages = [Recorded(topic, round(1e9 * t), t) for topic, t in zip(topics, times, strict=True)]
    found = without_earlier_gaps(Bag(Path("run"), tuple(messages), False), 10.0, latched=[DESCRIPTION])
    assert [item.message for item in found.messages] == [0.0, 9.8, 9.9, 10.0, 12.0]


def test_each_goal_of_a_packing_recording_is_measured_alone(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path)
    writer.write_goal(2.0, {**OUTCOME, "message": "first"})
    writer.write_goal(5.0, {**OUTCOME, "message": "second"})
    writer.close()
    for number, start, message in ((1, 2.0, "first"), (2, 5.0, "second")):
        run = load_run(tmp_path, number)
        assert (run.goal, run.outcome["message"]) == (GoalNumber(number, 2), message)
        assert run.start == pytest.approx(start)
        assert run.joint_times.min() >= start - 1e-9
        assert json.dumps(run.outcome)
