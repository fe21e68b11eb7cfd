"""The buttons that a cell is operated with, and which of them make sense in its present condition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from viser import GuiApi, GuiEvent

from pack_core.errors import PackError
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import boxed, lines, put


@dataclass(frozen=True)
class CellCondition:
    """The cell as whoever operates it has to know it.

    Attributes:
        is_up: whether the simulator has been heard of.
        waits_for: why no goal can be taken now, in words; empty where one can.
        is_busy: whether a goal is in progress.
        is_starting: whether a start was pressed whose goal has not been taken yet.
        is_paused: whether simulated time stands still.
        is_stopped: whether the arm was stopped and follows no setpoints.
    """

    is_up: bool = False
    waits_for: str = ""
    is_busy: bool = False
    is_starting: bool = False
    is_paused: bool = False
    is_stopped: bool = False

    @property
    def can_start(self) -> bool:
        """A goal at a time, and none in a cell that stands still or is not up."""
        return self.is_up and not (self.waits_for or self.is_busy or self.is_starting or self.is_paused)

    @property
    def can_cancel(self) -> bool:
        """There must be something to cancel, and time for it to end."""
        return self.is_up and self.is_busy and not self.is_paused

    @property
    def can_pause(self) -> bool:
        """Any time, and so can going on."""
        return self.is_up

    @property
    def can_stop(self) -> bool:
        """Always but when the arm is stopped already."""
        return self.is_up and not self.is_stopped

    @property
    def can_resume(self) -> bool:
        """Only after a stop, and once the goal that it ended has ended."""
        return self.is_up and self.is_stopped and not self.is_busy

    @property
    def in_words(self) -> str:
        """What the cell is at, or waits for."""
        if not self.is_up:
            return "waiting for the simulator"
        if self.is_stopped:
            return "the arm is stopped; resume, or start anew"
        if self.is_paused:
            return "paused"
        if self.is_busy:
            return "a goal is in progress"
        return "starting" if self.is_starting else self.waits_for or "ready for a goal"


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
