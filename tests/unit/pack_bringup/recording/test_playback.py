from pathlib import Path

import pytest

from pack_bringup.cli.bag import info
from pack_bringup.recording.playback import TICK, load_playback, stretch
from pack_core import stamps
from pack_core.errors import BagError
from pack_core.packing import topics
from pack_evaluation.raw_bag import read_raw_bag
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A goal from 2 s to 3 s, and the cell's description from before."""
    folder = tmp_path_factory.mktemp("run")
    writer = GoalWriter(folder)
    writer.write_goal(2.0, OUTCOME)
    writer.close()
    return folder


def test_everything_is_played_in_order_and_what_is_latched_before_the_start_at_once(bag: Path) -> None:
    playback = load_playback(bag)
    assert [message.topic for message in playback.early] == [topics.DESCRIPTION]
    assert stamps.to_seconds(playback.start_ns) == 2.0
    assert playback.duration == pytest.approx(1.0)
    events = list(playback.events(clock=False))
    assert events == list(playback.messages)
    times = [message.time_ns for message in playback.messages]
    assert times == sorted(times)


def test_pack_bag_info_tells_the_stretch_that_is_played(
    bag: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    playback = load_playback(bag)
    assert stretch(read_raw_bag(bag)) == (playback.start_ns, playback.end_ns)
    info(bag)
    assert f"{playback.duration:.3f} s of simulated time, from 2.000 s to 3.000 s" in capsys.readouterr().out


def test_a_stretch_begins_and_ends_where_it_should_and_keeps_the_description(bag: Path) -> None:
    playback = load_playback(bag, start=2.3, end=2.6)
    assert [message.topic for message in playback.early] == [topics.DESCRIPTION]
    assert stamps.to_seconds(playback.start_ns) == pytest.approx(2.3, abs=0.011)
    assert stamps.to_seconds(playback.end_ns) == pytest.approx(2.6, abs=0.011)


def test_only_the_chosen_topics_are_played(bag: Path) -> None:
    playback = load_playback(bag, [topics.JOINT_STATES])
    assert set(playback.topics) == {message.topic for message in playback.messages} == {topics.JOINT_STATES}
    assert len(playback.messages) == 101


def test_the_clock_ticks_every_4_ms_and_is_never_behind_a_message(bag: Path) -> None:
    playback = load_playback(bag, [topics.JOINT_STATES])
    ticks, now = [], -1
    for event in playback.events(clock=True):
        if isinstance(event, int):
            now = event
            ticks.append(event)
        else:
            assert event.time_ns - TICK < now <= event.time_ns
    assert ticks == list(range(playback.start_ns, playback.end_ns + 1, TICK))


def test_a_topic_that_was_not_recorded_is_named_with_those_that_were(bag: Path) -> None:
    assert set(load_playback(bag, heard=["/lidar", topics.JOINT_STATES]).topics) == {topics.JOINT_STATES}
    with pytest.raises(BagError, match=r"has none of /camera, /lidar"):
        load_playback(bag, heard=["/lidar", "/camera"])
    with pytest.raises(BagError, match=r"has no topic /camera, /lidar; it has .*/joint_states"):
        load_playback(bag, ["/lidar", "/camera", topics.JOINT_STATES])


def test_the_clock_is_played_by_its_option_alone(bag: Path) -> None:
    with pytest.raises(BagError, match="--clock sends one"):
        load_playback(bag, ["/clock"])


def test_a_stretch_without_messages_is_refused(bag: Path) -> None:
    with pytest.raises(BagError, match=r"no message to play .* from 50\.0 s"):
        load_playback(bag, start=50.0)


def test_of_topics_that_are_sent_once_alone_there_is_nothing_to_play(bag: Path) -> None:
    with pytest.raises(BagError, match=r"only what is sent once; .* without recorder.pictures"):
        load_playback(bag, [topics.DESCRIPTION])
