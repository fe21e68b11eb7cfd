"""The page: what all cells show in the same way, around a cell's own part."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from functools import partial
from typing import Any

from viser import GuiEvent, ViserServer

from pack_core import topics
from pack_viewer.cell_page import IDLE, UNHEARD, CameraPreset, CellPage
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import RED, facts, headline, put
from pack_viewer.news import News, NewsSource, Topics
from pack_viewer.node_board import NodeBoard

SHARED_TOPICS = Topics(states=(topics.REAL_TIME_FACTOR,), events=(topics.DIAGNOSTICS,))
"""What the page listens to in every cell."""
SHOW_PERIOD = 0.2
"""Texts and plots are brought up to date this often [s of wall clock]."""
SIDE_WIDTH, MAIN_WIDTH = 330, 320
"""Of the panels to the left and to the right of the scene [pixel]."""


class LivePage:
    """Shows one cell to any number of browsers.

    Args:
        server: the web server.
        cell_page: makes the cell's part.
        source: where news comes from.
        controls: adds what the cell, or the recording, is operated with; called with the log, and returns
            what brings it up to date.
        origin: what is shown, such as `live` or a recording's name.
        watched: nodes whose silence is a fault; None where no nodes run, as in a recording.
    """

    def __init__(
        self, server: ViserServer, cell_page: type[CellPage], source: NewsSource,
        controls: Callable[[EventLog], Callable[[], None]], *, origin: str,
        watched: Collection[str] | None = None,
    ) -> None:  # fmt: skip
        self._server, self._source, self._origin = server, source, origin
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False)
        self._headline = gui.add_html("")
        self._facts = gui.add_html("")
        self.log = EventLog()
        self.cell = cell_page(server, self.log)
        self.board = NodeBoard(self.log, watched)
        self._show_controls = controls(self.log)
        self._add_view(cell_page.presets)
        with gui.add_folder("Nodes"):
            self._nodes = gui.add_html("")
        self._add_side_panel()
        self._factor: float | None = None
        self._time: float | None = None
        self._next_show = 0.0

    def turn(self) -> None:
        """Take in the news and show it; to be called for every frame."""
        with self._server.atomic():  # a frame of the scene is never half old
            for news in self._source.take():
                if news.restarted:
                    self._forget()
                self._take(news)
                self.cell.update(news)
        if (now := time.monotonic()) >= self._next_show:
            self._next_show = now + SHOW_PERIOD
            self.show()

    def show(self) -> None:
        """Bring texts and plots up to date."""
        self.cell.show()
        head = self.cell.headline
        colour = RED if head.is_fault or self.board.has_fault else "inherit"
        put(self._headline, headline(head.title, head.note, colour))
        put(self._facts, facts(self._rows()))
        put(self._nodes, self.board.html())
        self._show_controls()
        self.log.send()

    def _take(self, news: News) -> None:
        self._time = news.time if news.time is not None else self._time
        if self.cell.headline is UNHEARD and self._time is not None:
            self.cell.headline = IDLE
        if (factor := news.newest(topics.REAL_TIME_FACTOR)) is not None:
            self._factor = factor.data
        for message in news.all(topics.DIAGNOSTICS):
            self.board.take(message, self._time)

    def _rows(self) -> list[tuple[str, str]]:
        rows = [("shown", self._origin)]
        if self._time is not None:
            rows.append(("simulated time", f"{self._time:.1f} s"))
        if self._factor is not None:
            rows.append(("real-time factor", f"{self._factor:.2f}"))
        return rows

    def _forget(self) -> None:
        self.log.clear()
        self.board.forget()
        self.cell.forget()

    def _add_view(self, presets: tuple[CameraPreset, ...]) -> None:
        gui, camera = self._server.gui, self._server.initial_camera
        camera.position, camera.look_at = presets[0].position, presets[0].look_at
        with gui.add_folder("View", expand_by_default=False):
            names = gui.add_button_group("look from", [preset.name for preset in presets])
            by_name = {preset.name: preset for preset in presets}
            names.on_click(lambda event: _look(event, by_name[event.target.value]))
            self.cell.view_options()
            dark = gui.add_checkbox("dark", initial_value=False)
            dark.on_update(lambda _: self._set_dark(dark.value))

    def _set_dark(self, dark: bool) -> None:
        self._server.gui.configure_theme(show_logo=False, show_share_button=False, dark_mode=dark)

    def _add_side_panel(self) -> None:
        gui = self._server.gui
        side = gui.add_panel()
        tabs: dict[str, Callable[[], None]] = {**self.cell.tabs(), "Log": partial(self.log.place, gui)}
        for title, fill in tabs.items():
            with side.add_tab(title):
                fill()
        side.dock_left()
        side.set_width(SIDE_WIDTH)
        main = self._server.gui.main_panel
        main.dock_right()
        main.set_width(MAIN_WIDTH)


def _look(event: GuiEvent[Any], preset: CameraPreset) -> None:
    """Move the camera of the browser whose button was pressed; the others keep theirs."""
    if event.client is not None:
        with event.client.atomic():
            event.client.camera.position = preset.position
            event.client.camera.look_at = preset.look_at
