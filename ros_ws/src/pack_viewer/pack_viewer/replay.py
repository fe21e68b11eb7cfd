"""A recording as one HTML file that can be turned and played in any browser, without a network."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np

from pack_core.cells import cell_part
from pack_evaluation.record import cell_of
from pack_viewer.cell_page import CellPage, CellScene
from pack_viewer.recorded_news import RecordedNews
from pack_viewer.web_server import open_server

VISER_TITLE = "<title>Viser</title>"
"""Title of the file that viser writes; ours is the recording's name."""
FRAME_RATE = 25.0
"""Frames a second of simulated time."""
MOST_FRAMES = 1500
"""A long recording has fewer frames a second, so that the file stays small."""


def write_replay(recording: Path, path: Path) -> None:
    """Write the replay of a recording.

    Args:
        recording: a run's folder, a bag's folder or an MCAP file.
        path: the HTML file to write.

    Raises:
        BagError: the recording is missing or broken.
    """
    page: type[CellPage] = cell_part(cell_of(recording), "page")
    news = RecordedNews(recording, page.scene_type.topics)
    news.is_paused = True  # time goes on frame by frame here
    # viser records what it would send to browsers, and has no scene without a server.
    server = open_server(0, recording.name)
    try:
        server.initial_camera.position = page.presets[0].position
        server.initial_camera.look_at = page.presets[0].look_at
        scene = page.scene_type(server.scene)
        _draw(scene, news)
        recorder = server.get_scene_serializer()
        for time, pause in _frames(news.start, news.end):
            recorder.insert_sleep(pause)
            news.seek(time)
            _draw(scene, news)
        path.write_text(
            recorder.as_html().replace(VISER_TITLE, f"<title>{escape(recording.name)}</title>", 1)
        )
    finally:
        server.stop()


def _draw(scene: CellScene, source: RecordedNews) -> None:
    for news in source.take():
        scene.update(news)


def _frames(start: float, end: float) -> list[tuple[float, float]]:
    """Times of the frames after the first [s of simulated time], each with the time since the one before."""
    count = int(np.clip((end - start) * FRAME_RATE, 1, MOST_FRAMES))
    times = np.linspace(start, end, count + 1)
    return list(zip(times[1:].tolist(), np.diff(times).tolist(), strict=True))
