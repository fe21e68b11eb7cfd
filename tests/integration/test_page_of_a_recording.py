"""A recording in a real browser: the page is drawn, told, held, and set to a time."""

import socket
import threading
from collections.abc import Iterator

import pytest

from pack_core.paths import project_root
from pack_viewer.bag_page import BagPage
from pack_viewer.replay import write_replay
from pack_viewer.web_server import open_server
from page_browser import changed_share, open_page, picture, steady_picture

SAMPLE = project_root() / "bags" / "samples" / "packing"


@pytest.fixture
def shown() -> Iterator[BagPage]:
    """The sample recording, played fast."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    server, ended = open_server(port, "PackCell"), threading.Event()
    page = BagPage(server, SAMPLE, rate=4.0)
    thread = threading.Thread(target=page.run, args=(ended,))
    thread.start()
    yield page
    ended.set()
    thread.join()
    server.stop()


@pytest.mark.timeout(300)
def test_a_recording_is_shown_to_its_end_and_held_and_set_back(shown: BagPage) -> None:
    with open_page(f"http://127.0.0.1:{shown.server.get_port()}") as browser:
        browser.wait_for_headline("placed")
        browser.wait_for_text("nothing may be pushed aside now")
        # At its end it is held: it can be set to any time, and its slider be moved by the keyboard.
        shown.news.seek(6.0)
        browser.wait_for_headline("INSERT")
        robot = shown.page.cell.scene.drawn.body("panda_link4")
        before = steady_picture(shown.server)
        robot.visible = False
        assert changed_share(before, picture(shown.server)) > 0.0005  # it was really drawn
        browser.page.get_by_role("slider").press("Home")
        browser.wait_for_headline("ready")
        browser.press("go on")
        browser.wait_for_headline("placed")
        assert browser.foreign_requests == []


@pytest.mark.timeout(300)
def test_a_replay_is_drawn_from_its_file_alone(tmp_path) -> None:
    write_replay(SAMPLE, tmp_path / "replay.html")
    with open_page((tmp_path / "replay.html").as_uri()) as browser:
        browser.wait_for_scene()
        assert browser.foreign_requests == []


def test_a_replay_is_titled_with_its_recording(tmp_path) -> None:
    write_replay(SAMPLE, tmp_path / "replay.html")
    assert "<title>packing</title>" in (tmp_path / "replay.html").read_text()


def test_a_recording_goes_where_somebody_has_put_its_slider() -> None:
    server = open_server(0, "PackCell")
    try:
        page = BagPage(server, SAMPLE)
        page.news.is_paused = True
        page.page.show()
        page.slider.value = 6.0  # as the server does in another thread, at any moment
        page.page.show()
        assert (page.news.time, page.slider.value) == (6.0, 6.0)
    finally:
        server.stop()


@pytest.mark.parametrize("start", [0.0, 1e6])
def test_a_page_that_is_to_begin_outside_of_its_recording_begins_at_its_nearest_moment(start: float) -> None:
    server = open_server(0, "PackCell")
    try:
        news = BagPage(server, SAMPLE, start=start).news
        assert news.time == (news.start if start < news.start else news.end)
    finally:
        server.stop()
