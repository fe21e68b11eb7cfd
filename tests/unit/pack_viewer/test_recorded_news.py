"""A recording is heard as a running cell is, and can be held, gone through faster, and set back."""

import pytest

from pack_core.errors import BagError
from pack_core.packing import topics
from pack_core.paths import project_root
from pack_viewer.news import Topics
from pack_viewer.recorded_news import RecordedNews

SAMPLE = project_root() / "bags" / "samples" / "packing"
READ = Topics(states=(topics.JOINT_STATES,), events=(topics.RESULT, topics.MPC_STATUS))


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
    assert news.take().time == pytest.approx(news.start + 3.0)


def test_of_a_state_only_the_newest_message_is_read_and_of_an_event_every_one(
    news: RecordedNews, wall: Wall
) -> None:
    wall.now = 4.0
    found = news.take()
    assert len(found.all(topics.JOINT_STATES)) == 1
    assert len(found.all(topics.MPC_STATUS)) > 10
    stamp = found.all(topics.JOINT_STATES)[0].header.stamp
    assert stamp.sec + 1e-9 * stamp.nanosec == pytest.approx(news.start + 4.0, abs=0.05)


def test_nothing_is_handed_out_twice(news: RecordedNews, wall: Wall) -> None:
    wall.now = 4.0
    news.take()
    assert not any(news.take().messages.values())


def test_a_held_recording_stands_still(news: RecordedNews, wall: Wall) -> None:
    news.is_paused, wall.now = True, 4.0
    assert news.take().time == news.start
    news.is_paused = False
    assert news.take().time == news.start  # the time that it was held is not made up for


def test_going_back_says_so_and_tells_again_what_was_before(news: RecordedNews, wall: Wall) -> None:
    wall.now = 100.0
    at_end = news.take()
    assert at_end.time == news.end
    assert at_end.newest(topics.RESULT) is not None
    news.seek(news.start + 3.0)
    back = news.take()
    assert back.restarted
    assert back.time == pytest.approx(news.start + 3.0)
    assert back.newest(topics.RESULT) is None
    assert 0 < len(back.all(topics.MPC_STATUS)) < len(at_end.all(topics.MPC_STATUS))


def test_a_time_outside_of_the_recording_is_its_nearest_end(news: RecordedNews) -> None:
    news.seek(-5.0)
    assert news.time == news.start
    news.seek(1e9)
    assert news.time == news.end


def test_a_recording_without_any_of_the_topics_is_refused() -> None:
    with pytest.raises(BagError, match="no message on /nothing"):
        RecordedNews(SAMPLE, Topics(states=("/nothing",)))
