"""A fill job on the page: what is packed and to come, also for who looks on later."""

import json
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from pack_core.packing import topics
from pack_viewer.event_log import EventLog
from pack_viewer.news import News
from pack_viewer.packing.packing_page import PackingPage
from pack_viewer.web_server import open_server

CAN = {"name": "can", "packed": True, "reason": "packed", "start": 1.0, "duration": 6.5}
GIANT = {"name": "giant", "packed": False, "reason": "put aside: <too big>", "start": 2.0, "duration": 0.0}


def progress(stage: str, item: str, done: list[dict[str, object]], to_come: list[str], **more: object) -> str:
    fills = [[float(i), 0.1 * i, 0.05 * i] for i in range(len(done) + 1)]
    given = {"time": 3.0, "start": 1.0, "stage": stage, "object": item, "to_come": to_come}
    return json.dumps({**given, "objects": done, "fills": fills, **more})


@pytest.fixture
def page() -> Iterator[PackingPage]:
    server = open_server(0, "fill")
    made = PackingPage(server, EventLog())
    for fill in made.tabs().values():
        fill()
    yield made
    server.stop()


def tell(page: PackingPage, text: str, topic: str = topics.FILL_PROGRESS) -> None:
    page.update(News({topic: [SimpleNamespace(data=text)]}, 3.0))
    page.show()


def test_the_object_in_work_and_the_fill_are_shown(page: PackingPage) -> None:
    tell(page, progress("pick", "tea", [CAN, GIANT], ["rice"]))
    assert page.headline.title == "pick tea"
    assert page.headline.note == "1 packed, 2 to come, 20 % of the base"
    shown = page._fill._objects.content
    assert [name in shown for name in ("✓", "can", "✕", "▶", "tea", "rice")] == [True] * 6
    assert "&lt;too big&gt;" in shown
    assert page._fill._plot.points[-1].tolist() == [2.0, 20.0, 10.0]


def test_what_became_of_an_object_is_logged_once(page: PackingPage) -> None:
    tell(page, progress("pick", "tea", [CAN], []))
    tell(page, progress("pack", "tea", [CAN], []))
    assert page.log.text.count("7.50 s  can: packed") == 1
    tell(page, progress("pick", "tea", [CAN], [], start=9.0))  # another job with the same list
    assert page.log.text.count("can: packed") == 2


def test_a_job_that_ended_says_how(page: PackingPage) -> None:
    tell(page, progress("pack", "tea", [CAN], []))
    result = {"exit_reason": "canceled", "message": "on request", "objects": [CAN]}
    tell(page, json.dumps(result), topics.FILL_RESULT)
    assert (page.headline.title, page.headline.is_fault) == ("canceled", True)
    assert "▶" not in page._fill._objects.content
    assert "tea: not finished" in page._fill._objects.content
    assert "1 of 2" in page._fill._values.content
