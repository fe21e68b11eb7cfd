from dataclasses import replace

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_core.packing.topics import JOINT_STATES, MARKERS
from pack_evaluation.bag import Bag
from pack_evaluation.track import Track
from pack_lockstep.packing.lockstep_config import PackingPreset
from pack_lockstep.packing.perception_replay import TOPICS, estimate_again, replay_perception
from replay.sample import COUNTS, sample, sample_run


@pytest.fixture(scope="module")
def estimated() -> dict[str, Track]:
    """The estimate after every marker frame, by object."""
    return estimate_again(sample(), PackingPreset())


def without(topic: str, keep: int) -> Bag:
    """The sample without every `keep`-th message of a topic."""
    there = [item for item in sample().messages if item.topic == topic]
    lost = {id(item) for item in there[::keep]}
    return replace(sample(), messages=tuple(item for item in sample().messages if id(item) not in lost))


def test_the_sample_holds_every_frame() -> None:
    counts = sample().counts()
    assert {topic: counts[topic] for topic in COUNTS} == COUNTS


def test_the_core_estimates_what_the_node_published() -> None:
    found = replay_perception(sample())
    assert {topic: found.inputs[topic] for topic in (JOINT_STATES, MARKERS)} == {
        topic: COUNTS[topic] for topic in (JOINT_STATES, MARKERS)
    }
    assert found.agrees, found.rows
    assert {row.name for row in found.rows} == sample_run().estimate.keys()
    for row in found.rows:
        assert row.compared > 100 * (sample_run().end - sample_run().start)
        assert row.mean_mm < 0.3, row.name


def test_the_replayed_estimate_stays_close_to_the_truth(estimated: dict[str, Track]) -> None:
    for name, track in estimated.items():
        errors = track.distance_to(sample_run().truth[name].at(track.times).p)
        assert np.max(errors) < 5e-3, name
        assert np.mean(errors) < 1e-3, name


def test_under_another_preset_the_core_estimates_something_else() -> None:
    lazy = PackingPreset(perception={"correction": {"pose_gain": 1e-4, "twist_gain": 0.0}})
    assert not replay_perception(sample(), lazy).agrees


@pytest.mark.parametrize("topic", TOPICS[1:])
def test_a_recording_that_lacks_frames_is_refused(topic: str) -> None:
    with pytest.raises(BagError, match=rf"messages on {topic}; a replay needs at least 99 %"):
        replay_perception(without(topic, keep=20))


def test_a_recording_without_markers_is_refused() -> None:
    with pytest.raises(BagError, match=f"0 messages on {MARKERS}"):
        replay_perception(without(MARKERS, keep=1))
