"""A recording is heard as a running cell is, and can be held, gone through faster, and set back."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_core.packing import topics
from pack_core.paths import project_root
from pack_viewer import recorded_news
from pack_viewer.news import News, Topics, seconds
from pack_viewer.recorded_news import RecordedNews
from pack_viewer.rolling_plot import PERIOD

SAMPLE = project_root() / "bags" / "samples" / "packing"
READ = Topics(
    states=(topics.JOINT_STATES, topics.WRENCH),
    events=(topics.RESULT, topics.MPC_STATUS),
    followed=(topics.WRENCH,),
)


def told(pieces: Sequence[News], topic: str) -> list[Any]:
    """All messages of a topic, in the order in which they were told."""
    return [message for piece in pieces for message in piece.all(topic)]


class Wall:
    """A wall clock that stands still."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def wall() -> Wall:
    return Wall()


@pytest.fixture
def news(wall: Wall) -> RecordedNews:
    found = RecordedNews(SAMPLE, READ, clock=wall)
    found.take()
    return found


def test_simulated_time_keeps_to_the_rate(news: RecordedNews, wall: Wall) -> None:
    news.rate, wall.now = 2.0, 1.5
    assert news.take()[-1].time == pytest.approx(news.start + 3.0)


def test_of_a_state_only_the_newest_message_is_read_and_of_an_event_every_one(
    news: RecordedNews, wall: Wall
) -> None:
    wall.now = 4.0
    found = news.take()
    (joints,) = told(found, topics.JOINT_STATES)
    assert seconds(joints) == pytest.approx(news.start + 4.0, abs=0.05)
    statuses = [seconds(message) for message in told(found, topics.MPC_STATUS)]
    assert len(statuses) > 10
    assert statuses == sorted(set(statuses))


def test_what_is_followed_is_told_as_it_was_on_the_way(news: RecordedNews) -> None:
    news.seek(news.start + 4.0)
    pieces = news.take()
    wrenches = [seconds(message) for message in told(pieces, topics.WRENCH)]
    assert np.diff(wrenches).max() < PERIOD
    assert wrenches[-1] - wrenches[0] > 3.9
    assert all(np.diff([piece.time for piece in pieces]) > 0.0)
    for piece in pieces:  # and no message before its time; the clock that a recording is stamped by is coarse
        assert all(seconds(message) < piece.time + 0.01 for message in piece.all(topics.WRENCH))


def test_what_lies_longer_ago_than_plots_reach_is_one_piece(
    news: RecordedNews, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorded_news, "WAY", 10 * recorded_news.PIECE)
    news.seek(news.start + 4.0)
    pieces = news.take()
    assert len(pieces) <= 11
    assert len(told(pieces, topics.MPC_STATUS)) > 10


def test_nothing_is_handed_out_twice(news: RecordedNews, wall: Wall) -> None:
    wall.now = 4.0
    news.take()
    (again,) = news.take()
    assert not any(again.messages.values())


def test_a_held_recording_stands_still(news: RecordedNews, wall: Wall) -> None:
    news.is_paused, wall.now = True, 4.0
    assert news.take()[-1].time == news.start
    news.is_paused = False
    assert news.take()[-1].time == news.start  # the time that it was held is not made up for


def test_going_back_says_so_and_tells_again_what_was_before(news: RecordedNews, wall: Wall) -> None:
    wall.now = 100.0
    at_end = news.take()
    assert at_end[-1].time == news.end
    assert told(at_end, topics.RESULT)
    news.seek(news.start + 3.0)
    back = news.take()
    assert [piece.restarted for piece in back] == [True] + [False] * (len(back) - 1)
    assert back[-1].time == pytest.approx(news.start + 3.0)
    assert not told(back, topics.RESULT)
    assert 0 < len(told(back, topics.MPC_STATUS)) < len(told(at_end, topics.MPC_STATUS))


def test_a_time_outside_of_the_recording_is_its_nearest_end(news: RecordedNews) -> None:
    news.seek(-5.0)
    assert news.time == news.start
    news.seek(1e9)
    assert news.time == news.end


def test_a_recording_without_any_of_the_topics_is_refused() -> None:
    with pytest.raises(BagError, match="no message on /nothing"):
        RecordedNews(SAMPLE, Topics(states=("/nothing",)))
