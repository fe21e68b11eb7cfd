"""Box vision and the layout planner on what their nodes received in a recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from pack_core.errors import BagError
from pack_core.motion.topics import IMAGE
from pack_core.palletizing.topics import BOX_DETECTION, LAYOUT_EVENTS
from pack_evaluation.bag import Bag, Recorded
from pack_lockstep.palletizing.replay import replay_layout, replay_vision
from pack_lockstep.replay import RunConditions
from replay.sample import sample_of

COUNTS = {BOX_DETECTION: 2, IMAGE: 2, LAYOUT_EVENTS: 2}
"""Messages that the sample holds; comparisons count for nothing if some are missing."""
RUN = RunConditions()


@pytest.fixture
def sample() -> Bag:
    found = sample_of("palletizing")
    assert {topic: found.counts()[topic] for topic in COUNTS} == COUNTS
    return found


def changed(bag: Bag, topic: str, change: Callable[[Any], Any]) -> Bag:
    """The recording with other messages of a topic."""
    messages = [
        Recorded(item.topic, item.time_ns, change(item.message)) if item.topic == topic else item
        for item in bag.messages
    ]
    return replace(bag, messages=tuple(messages))


def test_vision_detects_what_the_node_detected(sample: Bag) -> None:
    found = replay_vision(sample, RUN)
    assert found.agrees, found.rows
    assert len(found.rows) == COUNTS[BOX_DETECTION]


def test_another_detection_is_noticed(sample: Bag) -> None:
    def moved(message: Any) -> Any:
        at = message.pose.position
        return replace(message, pose=replace(message.pose, position=replace(at, x=at.x + 1e-4)))

    found = replay_vision(changed(sample, BOX_DETECTION, moved), RUN)
    assert [row.difference_mm for row in found.rows] == pytest.approx([0.1, 0.1])
    assert not found.agrees


def test_under_another_preset_vision_detects_something_else(sample: Bag) -> None:
    assert not replay_vision(sample, RunConditions(preset="thesis")).agrees


def test_a_detection_whose_picture_was_not_recorded_is_refused(sample: Bag) -> None:
    first = next(item for item in sample.messages if item.topic == IMAGE)
    rest = tuple(item for item in sample.messages if item is not first)
    with pytest.raises(BagError, match="but not that picture"):
        replay_vision(replace(sample, messages=rest), RUN)


def test_the_planner_answers_the_layout_that_the_node_answered(sample: Bag) -> None:
    found = replay_layout(sample, RUN)
    assert found.agrees, found.rows
    assert len(found.rows) == 1


def test_under_another_preset_there_is_another_layout(sample: Bag) -> None:
    assert not replay_layout(sample, RunConditions(preset="thesis")).agrees
