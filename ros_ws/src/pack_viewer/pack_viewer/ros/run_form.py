"""What can be chosen for the next goal, and the messages that it becomes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from viser import GuiApi, UploadedFile

from pack_core.errors import PackError
from pack_core.ros.contracts.contract import Contract
from pack_core.text.reader import decoded, read_text
from pack_core.text.shown import on_one_line
from pack_viewer.event_log import EventLog


class RunForm(ABC):
    """The widgets of a cell's goal.

    Args:
        gui: where `add` puts them.
        log: is told of files that are refused.
    """

    def __init__(self, gui: GuiApi, log: EventLog) -> None:
        self.gui, self.log = gui, log

    @abstractmethod
    def add(self) -> None:
        """Add the widgets."""

    @abstractmethod
    def reset(self) -> tuple[Contract, Any]:
        """The service that brings the cell into the chosen scene, and its request; raises PackError."""

    @abstractmethod
    def goal(self) -> tuple[Contract, Any]:
        """The action, and the chosen goal; raises PackError."""


class FileChoice:
    """A file from a list, or one that a browser has uploaded.

    Args:
        form: where it is shown.
        label: what the files are.
        files: those that are there, by name; an empty path stands for none.
        check: raises PackError for a text that must not be used; called with the text and the file's name.
        read: the text that a file of the list stands for.
    """

    def __init__(
        self,
        form: RunForm,
        label: str,
        files: Mapping[str, Path | None],
        check: Callable[[str, str], Any],
        read: Callable[[Path], str] = read_text,
    ) -> None:
        self._log, self._files, self._check, self._read = form.log, dict(files), check, read
        self._uploaded: dict[str, str] = {}
        self._list = form.gui.add_dropdown(label, tuple(files))
        self._button = button = form.gui.add_upload_button(f"upload {label}", color="gray")
        button.on_upload(lambda _: self.take(button.value))

    @property
    def name(self) -> str:
        """What is chosen."""
        return str(self._list.value)

    @property
    def text(self) -> str:
        """The chosen file's text; empty where none is chosen."""
        if self.name in self._uploaded:
            return self._uploaded[self.name]
        path = self._files[self.name]
        return self._read(path) if path else ""

    def set_visible(self, visible: bool) -> None:
        """Show or hide it."""
        self._list.visible = self._button.visible = visible

    def take(self, file: UploadedFile) -> None:
        """Choose a file that a browser has uploaded, unless it must not be used."""
        name = on_one_line(file.name)
        try:
            text = decoded(file.content, name)
            self._check(text, name)
        except PackError as error:
            self._log.add(f"upload refused: {error}", "error")
            return
        shown = f"{name} (uploaded)"
        self._uploaded[shown] = text
        self._list.options = tuple(dict.fromkeys([*self._list.options, shown]))
        self._list.value = shown
        self._log.add(f"uploaded {name}", "person")
