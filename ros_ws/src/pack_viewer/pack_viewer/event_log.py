"""The last things that happened, newest first."""

from __future__ import annotations

import threading
from collections import deque

from viser import GuiApi, GuiHtmlHandle

from pack_viewer.fragments import BLUE, GREY, ORANGE, RED, signed_list

KEPT = 60
"""Entries: more than anybody scrolls through, and sent anew with each that is added."""
EMPTY = "nothing has happened yet"
SIGNS = {"info": ("·", GREY), "warning": ("▲", ORANGE), "error": ("✕", RED), "person": ("☞", BLUE)}
"""Sign and colour by kind; `person` marks what somebody at a browser did."""


class EventLog:
    """Any thread may add to it; the page shows it when it is asked to."""

    def __init__(self) -> None:
        self._handle: GuiHtmlHandle | None = None
        self._entries: deque[tuple[str, str, str]] = deque(maxlen=KEPT)
        self._lock, self._changed = threading.Lock(), False

    def place(self, gui: GuiApi) -> None:
        """Show it in the container that is open."""
        self._handle = gui.add_html(signed_list((), EMPTY))

    def add(self, text: str, kind: str = "info", time: float | None = None) -> None:
        """Note what happened, at simulated time `time` [s] where it is known."""
        sign, colour = SIGNS[kind]
        stamp = "" if time is None else f"{time:.2f} s  "
        with self._lock:
            self._entries.appendleft((sign, colour, stamp + text))
            self._changed = True

    @property
    def text(self) -> str:
        """All entries as plain text, newest first, a line each."""
        with self._lock:
            return "\n".join(text for _, _, text in self._entries)

    def clear(self) -> None:
        """Forget everything but what people did."""
        with self._lock:
            self._entries = deque((e for e in self._entries if e[0] == SIGNS["person"][0]), KEPT)
            self._changed = True

    def send(self) -> None:
        """Show what was added."""
        with self._lock:
            if not self._changed or self._handle is None:
                return
            entries, self._changed = tuple(self._entries), False
        self._handle.content = signed_list(entries, EMPTY)
