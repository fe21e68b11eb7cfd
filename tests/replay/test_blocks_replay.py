"""Tag perception and the rearrangement planner on what their nodes received in a recording."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pack_core.blocks.topics import BLOCK_POSES, REARRANGEMENT_EVENTS
from pack_core.motion.topics import IMAGE
from pack_evaluation.bag import Bag
from pack_lockstep.blocks.replay import replay_rearrangement, replay_tags
from pack_lockstep.replay import RunConditions, calls_in
from replay.sample import sample_of

COUNTS = {BLOCK_POSES: 2, IMAGE: 2, REARRANGEMENT_EVENTS: 2}
"""Messages that the sample holds; comparisons count for nothing if some are missing."""
RUN = RunConditions()
pytestmark = pytest.mark.usefixtures("compiled")


@pytest.fixture
def sample() -> Bag:
    found = sample_of("blocks")
    assert {topic: found.counts()[topic] for topic in COUNTS} == COUNTS
    return found


def test_the_planner_comes_to_the_plan_that_the_node_answered(sample: Bag) -> None:
    (call,) = calls_in(sample, REARRANGEMENT_EVENTS)
    assert len(call.answer.actions) >= 4
    found = replay_rearrangement(sample, RUN)
    assert found.agrees, found.rows
    assert len(found.rows) == 1


def test_another_seed_gives_another_plan(sample: Bag, monkeypatch: pytest.MonkeyPatch) -> None:
    (call,) = calls_in(sample, REARRANGEMENT_EVENTS)
    monkeypatch.setattr(call.request, "seed", call.request.seed + 1)
    assert not replay_rearrangement(sample, RUN).agrees


def test_tags_are_seen_where_the_node_saw_them(sample: Bag) -> None:
    found = replay_tags(sample, RUN)
    assert found.agrees, found.rows
    assert len(found.rows) == COUNTS[BLOCK_POSES]


def test_a_block_that_was_seen_elsewhere_is_noticed(sample: Bag) -> None:
    messages = tuple(
        replace(item, message=replace(item.message, blocks=moved(item.message.blocks)))
        if item.topic == BLOCK_POSES
        else item
        for item in sample.messages
    )
    rows = replay_tags(replace(sample, messages=messages), RUN).rows
    assert [row.difference_mm for row in rows] == pytest.approx([0.1, 0.1])


def moved(blocks: list) -> list:
    """The first block 0.1 mm aside."""
    return [replace(blocks[0], x=blocks[0].x + 1e-4), *blocks[1:]]
