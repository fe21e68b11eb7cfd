"""The page of a recording: `pack play BAG --live`."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from viser import ViserServer

from pack_core.cells import cell_part
from pack_evaluation.record import cell_of
from pack_viewer.cell_page import CellPage
from pack_viewer.event_log import EventLog
from pack_viewer.live_page import SHARED_TOPICS, LivePage
from pack_viewer.recorded_news import RecordedNews

TURN = 1.0 / 30.0
"""Time between two checks of the recording [s of wall clock]."""
RATES = ("0.1", "0.25", "0.5", "1", "2", "4", "8")


class BagPage:
    """Shows a recording, with a slider over its time.

    Args:
        server: the web server.
        bag: a run's folder, a bag's folder or an MCAP file.
        rate: simulated seconds a second of wall clock.
        start: simulated time to begin at [s], or the nearest that was recorded; None: the first moment.

    Attributes:
        server: as given.
        news: the recording, which can be held and set to a time.
        page: what is shown.
        slider: over the recording's time; where somebody puts it, the recording goes.

    Raises:
        BagError: the recording is missing or broken.
    """

    def __init__(
        self, server: ViserServer, bag: Path, *, rate: float = 1.0, start: float | None = None
    ) -> None:
        cell = cell_of(bag)
        page: type[CellPage] = cell_part(cell, "page")
        self.server = server
        self.news = RecordedNews(bag, page.topics + SHARED_TOPICS, start=start)
        self.news.rate = rate
        self.page = LivePage(
            server, page, self.news, self._add_controls, origin=f"{cell}, recorded: {bag.name}"
        )

    def run(self, ended: threading.Event) -> None:
        """Play until `ended` is set."""
        while not ended.is_set():
            begun = time.monotonic()
            self.page.turn()
            ended.wait(max(0.0, begun + TURN - time.monotonic()))

    def _add_controls(self, log: EventLog) -> Callable[[], None]:
        gui, news = self.server.gui, self.news
        with gui.add_folder("Recording"):
            first, last = round(news.start, 2), round(news.end, 2)
            self._shown = round(news.time, 2)
            self.slider: Any = gui.add_slider(
                "time [s]", min=first, max=max(last, first + 0.01), step=0.01, initial_value=self._shown,
            )  # fmt: skip
            self._pause = gui.add_button("pause")
            self._pause.on_click(lambda _: self._set_paused(not news.is_paused))
            given = f"{news.rate:g}"
            rates = RATES if given in RATES else tuple(sorted((*RATES, given), key=float))
            rate = gui.add_dropdown("rate", rates, initial_value=given)
            rate.on_update(lambda _: setattr(news, "rate", float(rate.value)))
        return self._follow

    def _set_paused(self, paused: bool) -> None:
        if not paused and self.news.time >= self.news.end:
            self.news.seek(self.news.start)
        self.news.is_paused = paused
        self._pause.label = "go on" if paused else "pause"

    def _follow(self) -> None:
        # Asked for here and not told by a callback: that would come later, when it may have been set back.
        if self.slider.value != self._shown:
            self.news.seek(float(self.slider.value))
        self._shown = round(self.news.time, 2)
        if self._shown != self.slider.value:
            self.slider.value = self._shown
        if self.news.time >= self.news.end and not self.news.is_paused:
            self._set_paused(True)
