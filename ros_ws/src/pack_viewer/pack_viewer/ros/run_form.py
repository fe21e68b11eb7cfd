"""What can be chosen for the next goal, and the messages that it becomes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from viser import GuiApi, UploadedFile

from pack_core.errors import PackError
from pack_core.ros.contracts.contract import Contract
from pack_core.text.reader import decoded, read_text
from pack_core.text.shown import on_one_line
from pack_viewer.event_log import EventLog


@dataclass(frozen=True)
class TunedParameters:
    """Parameters of a node that can be changed on the page.

    Attributes:
        node: whose they are.
        prefix: what their names begin with, before a dot.
        title: above them.
    """

    node: str
    prefix: str
    title: str


class RunForm(ABC):
    """The widgets of a cell's goal.

    Args:
        gui: where `add` puts them.
        log: is told of files that are refused.
    """

    tuned: ClassVar[TunedParameters | None] = None
    """Parameters that sliders are made of."""

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


@dataclass(frozen=True)
class FileKind:
    """Files of one kind.

    Attributes:
        label: what they are.
        files: those that are there, by name; an empty path stands for none.
        check: raises PackError for a text that must not be used; called with the text and the file's name.
        read: the text that a file of the list stands for.
    """

    label: str
    files: Mapping[str, Path | None]
    check: Callable[[str, str], Any]
    read: Callable[[Path], str] = read_text


class FileChoice:
    """A file from a list, or one that a browser has uploaded.

    Args:
        form: where it is shown.
        kind: what can be chosen.
    """

    def __init__(self, form: RunForm, kind: FileKind) -> None:
        self._log, self._kind = form.log, kind
        self._uploaded: dict[str, str] = {}
        self._list = form.gui.add_dropdown(kind.label, tuple(kind.files))
        self._button = form.gui.add_upload_button(f"upload {kind.label}", color="gray")
        self._button.on_upload(lambda _: self.take(self._button.value))

    def follow(self, on_choice: Callable[[str], None]) -> None:
        """Have `on_choice` called with what is chosen now, and whenever something else is."""
        self._list.on_update(lambda _: on_choice(self.name))
        on_choice(self.name)

    def offer(self, kind: FileKind) -> None:
        """Let files of another kind be chosen instead; what was uploaded is forgotten."""
        self._kind, self._uploaded = kind, {}
        self._list.label, self._button.label = kind.label, f"upload {kind.label}"
        self._list.options = tuple(kind.files)
        self._list.value = next(iter(kind.files))

    @property
    def name(self) -> str:
        """What is chosen."""
        return str(self._list.value)

    @property
    def text(self) -> str:
        """The chosen file's text; empty where none is chosen."""
        if self.name in self._uploaded:
            return self._uploaded[self.name]
        path = self._kind.files[self.name]
        return self._kind.read(path) if path else ""

    def take(self, file: UploadedFile) -> None:
        """Choose a file that a browser has uploaded, unless it must not be used."""
        name = on_one_line(file.name)
        try:
            text = decoded(file.content, name)
            self._kind.check(text, name)
        except PackError as error:
            self._log.add(f"upload refused: {error}", "error")
            return
        shown = f"{name} (uploaded)"
        self._uploaded[shown] = text
        self._list.options = tuple(dict.fromkeys([*self._list.options, shown]))
        self._list.value = shown
        self._log.add(f"uploaded {name}", "person")
