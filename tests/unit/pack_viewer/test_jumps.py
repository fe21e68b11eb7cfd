"""A page that is set to a time shows what it would show if it had been played up to there."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from viser import ViserServer

from pack_bringup.recording.recorder import Recorder
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core import stamps
from pack_core.bag_topic import Topic
from pack_core.blocks import topics as blocks
from pack_core.motion import topics as motion
from pack_core.palletizing import topics as palletizing
from pack_core.palletizing.cell import PALLET
from pack_core.paths import project_root
from pack_viewer.blocks.blocks_page import BlocksPage
from pack_viewer.live_page import SHARED_TOPICS, LivePage
from pack_viewer.packing.packing_page import PackingPage
from pack_viewer.palletizing.palletizing_page import PalletizingPage
from pack_viewer.recorded_news import RecordedNews
from pack_viewer.rolling_plot import PERIOD, RollingPlot
from pack_viewer.web_server import open_server
from pallet_fsm.states import State
from unit.pack_evaluation.packing.messages import make

TYPES = message_types()
LENGTH, RATE = 20.0, 50
"""Of the recordings that are written here [s], [Hz]."""
STATES = ("1 spawn", "2 above box", "3 grasp", "4 lift")


@pytest.fixture
def server() -> Iterator[ViserServer]:
    opened = open_server(0, "jumps")
    yield opened
    opened.stop()


def palletizing_bag(folder: Path) -> Path:
    """An arm whose path error grows, and a machine that enters a state every five seconds."""
    kinds = {motion.MOTION_STATUS: "MotionStatus", palletizing.GRIPPER_STATE: "GripperState"}
    rows = [
        (at, topic, {"path_error": 1e-3 * at} if topic == motion.MOTION_STATUS else {"moment": at})
        for at in np.arange(0.0, LENGTH, 1.0 / RATE)
        for topic in kinds
    ]
    rows += [
        (5.0 * i, palletizing.PALLET_STATE, {"state": state, "box": "a"}) for i, state in enumerate(STATES)
    ]
    return write(folder, {**kinds, palletizing.PALLET_STATE: "PalletState"}, rows)


def blocks_bag(folder: Path) -> Path:
    """An arm whose path error grows, and jaws that open."""
    kinds = {motion.MOTION_STATUS: "MotionStatus", blocks.JAW_STATE: "JawState"}
    rows = [
        (at, topic, {"path_error": 1e-3 * at} if topic == motion.MOTION_STATUS else {"opening": 1e-3 * at})
        for at in np.arange(0.0, LENGTH, 1.0 / RATE)
        for topic in kinds
    ]
    return write(folder, kinds, rows)


def write(folder: Path, kinds: dict[str, str], rows: list[tuple[float, str, dict[str, Any]]]) -> Path:
    """Record messages, each with its time [s], topic and fields."""
    names = {topic: kind if "/" in kind else f"pack_interfaces/msg/{kind}" for topic, kind in kinds.items()}
    bag = Recorder(folder / "bag", [Topic(*item) for item in names.items()], TYPES)
    for at, topic, fields in sorted(rows, key=lambda row: row[0]):
        message, time_ns = make(names[topic], **fields), stamps.to_ns(float(at))
        if hasattr(message, "header"):
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(time_ns, 10**9)
        bag.write(topic, time_ns, bytes(TYPES.serialize_cdr(message, names[topic])))
    bag.close()
    return folder


def plots_of(page: LivePage) -> list[np.ndarray]:
    """The points of all plots."""
    return [value.points for value in vars(page.cell).values() if isinstance(value, RollingPlot)]


def open_recording(server: ViserServer, bag: Path, kind: type[Any]) -> tuple[LivePage, RecordedNews]:
    """The page of a held recording."""
    server.gui.reset()
    server.scene.reset()
    news = RecordedNews(bag, kind.topics + SHARED_TOPICS)
    news.is_paused = True
    page = LivePage(server, kind, news, lambda _: lambda: None, origin="test")
    page.turn()
    return page, news


def go(page: LivePage, news: RecordedNews, *times: float) -> LivePage:
    """Set the recording to times after its start, one after the other."""
    for time in times:
        news.seek(news.start + time)
        page.turn()
    return page


@pytest.mark.parametrize(
    ("kind", "write_bag", "at"),
    [
        (PackingPage, lambda _: project_root() / "bags" / "samples" / "packing", 6.0),
        (PalletizingPage, palletizing_bag, 4.0),
        (BlocksPage, blocks_bag, 4.0),
    ],
)
def test_after_a_jump_plots_and_log_are_those_of_a_recording_that_was_played(
    server: ViserServer, tmp_path: Path, kind: type[Any], write_bag: Any, at: float
) -> None:
    bag = write_bag(tmp_path)
    played = go(*open_recording(server, bag, kind), *np.arange(0.05, at + 0.02, 0.05))
    page, news = open_recording(server, bag, kind)
    for way in ((1.0, at), (at + 2.5, at)):  # on, and back
        go(page, news, *way)
        assert page.log.text == played.log.text
        assert page.cell.headline == played.cell.headline
        for points, wanted in zip(plots_of(page), plots_of(played), strict=True):
            assert len(points) == pytest.approx(len(wanted), rel=0.2)
            np.testing.assert_allclose(points[[0, -1], 0], wanted[[0, -1], 0], atol=2 * PERIOD)
            if kind is not PackingPage:  # a force changes faster than it is plotted
                again = [np.interp(points[:, 0], wanted[:, 0], column) for column in wanted.T]
                np.testing.assert_allclose(points, np.transpose(again), rtol=0.02, atol=2 * PERIOD)


def orders_bag(folder: Path) -> Path:
    """Two orders of a box each, five seconds one after the other, whose places are published first."""
    kinds = {
        palletizing.PALLET_STATE: "PalletState",
        motion.GOAL_MARKERS: "visualization_msgs/msg/MarkerArray",
    }
    steps = (State.SPAWN, State.DEPOSIT, State.RETREAT, State.DONE)
    rows: list[tuple[float, str, dict[str, Any]]] = [
        (begin + 1.0 + i, palletizing.PALLET_STATE, {"state": step.label, "box": box, "place": PALLET})
        for begin, box in ((0.0, "a"), (5.0, "b"))
        for i, step in enumerate(steps)
    ]
    rows += [(begin + 0.5, motion.GOAL_MARKERS, {}) for begin in (0.0, 5.0)]
    return write(folder, kinds, rows)


@pytest.mark.parametrize("way", [(9.0,), (4.5, 9.0), (9.5, 2.0, 9.0)])
def test_each_order_begins_with_nothing_placed(
    server: ViserServer, tmp_path: Path, way: tuple[float, ...]
) -> None:
    page, news = open_recording(server, orders_bag(tmp_path), PalletizingPage)
    go(page, news, *way)
    assert page.cell._progress.placed == ["b"]


def test_states_that_were_passed_are_ticked_after_a_jump(server: ViserServer, tmp_path: Path) -> None:
    page, news = open_recording(server, palletizing_bag(tmp_path), PalletizingPage)
    go(page, news, 12.0)
    assert page.cell.headline.title == "3 grasp"
    assert "1 spawn" in page.log.text
    go(page, news, 7.0)
    assert page.cell.headline.title == "2 above box"
    assert "3 grasp" not in page.log.text
