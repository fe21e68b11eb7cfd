"""The buttons that a cell is operated with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from viser import GuiApi, GuiEvent

from pack_core.cell_condition import CellCondition
from pack_core.errors import PackError
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import boxed, lines, put


class CellOperator(Protocol):
    """What a cell can be asked for; every call returns at once, and `who` is for its log."""

    @property
    def condition(self) -> CellCondition:
        """What the cell is at."""

    def start(self, who: str) -> None:
        """Bring the cell into the chosen scene and send the chosen goal."""

    def cancel(self, who: str) -> None:
        """End the goal in progress, whoever sent it."""

    def set_paused(self, paused: bool, who: str) -> None:
        """Let simulated time stand still, or run on."""

    def stop(self, who: str) -> None:
        """Brake the arm at once."""

    def resume(self, who: str) -> None:
        """Let the arm follow setpoints again after a stop."""


class RunPanel:
    """Buttons of which only those can be pressed that make sense now.

    Args:
        gui: where they are added.
        log: is told who pressed what.
        operator: does what they say.
        add_form: adds what can be chosen for the next goal.
    """

    def __init__(
        self, gui: GuiApi, log: EventLog, operator: CellOperator, add_form: Callable[[], None]
    ) -> None:
        self._log, self._operator = log, operator
        with gui.add_folder("Run"):
            add_form()
            self._words = gui.add_html("")
            self._start = self._button(gui, "start", operator.start)
            self._pause = self._button(gui, "pause", self._toggle_pause)
            self._cancel = self._button(gui, "cancel", operator.cancel)
            self._stop = self._button(gui, "STOP", operator.stop, color="red")
            self._resume = self._button(gui, "resume after stop", operator.resume)

    def show(self) -> None:
        """Let only those buttons be pressed that make sense now."""
        now = self._operator.condition
        put(self._words, boxed(lines([now.in_words])))
        for button, can in (
            (self._start, now.can_start), (self._pause, now.can_pause), (self._cancel, now.can_cancel),
            (self._stop, now.can_stop), (self._resume, now.can_resume),
        ):  # fmt: skip
            if button.disabled == can:
                button.disabled = not can
        label = "go on" if now.is_paused else "pause"
        if self._pause.label != label:
            self._pause.label = label
        if self._resume.visible != now.is_stopped:
            self._resume.visible = now.is_stopped

    def _toggle_pause(self, who: str) -> None:
        self._operator.set_paused(not self._operator.condition.is_paused, who)

    def _button(self, gui: GuiApi, label: str, act: Callable[[str], None], color: Any = None) -> Any:
        button = gui.add_button(label, color=color, disabled=True)

        def on_click(event: GuiEvent[Any]) -> None:
            who = "browser" if event.client is None else f"browser {event.client.client_id + 1}"
            self._log.add(f"{who}: {button.label}", "person")
            try:
                act(who)
            except PackError as error:
                self._log.add(str(error), "error")

        button.on_click(on_click)
        return button
