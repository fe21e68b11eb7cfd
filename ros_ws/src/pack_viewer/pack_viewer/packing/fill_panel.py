"""How far a fill job has come: the objects of its list, and how full the container is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from viser import GuiApi

from pack_viewer.fragments import GREEN, GREY, ORANGE, RED, boxed, chips, facts, put, signed_list
from pack_viewer.rolling_plot import RollingPlot

FILL_STAGES = ("arrange", "present", "pick", "pack", "set_down", "release")
"""What happens with an object, in order."""
Progress = Mapping[str, Any]
"""Content of a message of /fill_container/progress."""


class FillPanel:
    """Shows the job in progress, or the last one.

    Attributes:
        object: name of the object in work; empty between two, and while no job is in progress.
    """

    def __init__(self) -> None:
        self._progress: Progress | None = None
        self.object, self._unfinished = "", ""

    def add(self, gui: GuiApi) -> None:
        """Add it to the container that is open."""
        self._chips = gui.add_html("")
        self._objects = gui.add_html("")
        self._values = gui.add_html("")
        self._plot = RollingPlot(gui, "fill [%]", ("base", "volume"), period=0.0)

    def take(self, progress: Progress) -> Sequence[Mapping[str, Any]]:
        """Take up where a job stands; the objects that it has done with since the last time."""
        before = self._progress
        is_another = before is None or before["start"] != progress["start"]
        known = 0 if before is None or is_another else len(before["objects"])
        self._progress, self.object, self._unfinished = progress, str(progress["object"]), ""
        self._plot.clear()
        for at, base, volume in progress["fills"]:
            self._plot.add(at, 100.0 * base, 100.0 * volume)
        return list(progress["objects"][known:])

    def end(self) -> None:
        """The job has ended, maybe with an object in work."""
        self.object, self._unfinished = "", self.object

    def clear(self) -> None:
        """There was no job yet."""
        self._progress, self.object, self._unfinished = None, "", ""
        self._plot.clear()

    @property
    def is_packing(self) -> bool:
        """Whether the object in work is on its way into the container, led by the controller."""
        return bool(self.object) and self._progress is not None and self._progress["stage"] == "pack"

    @property
    def in_words(self) -> str:
        """How many objects are packed and to come, and how full the container is."""
        if self._progress is None:
            return ""
        return f"{self._packed} packed, {self._to_come} to come, {self._fill[0]:.0f} % of the base"

    def show(self) -> None:
        """Bring texts and plot up to date."""
        progress = self._progress
        put(self._objects, signed_list(self._rows(), "no container was filled yet"))
        self._plot.set_visible(progress is not None)
        self._plot.send()
        if progress is None:
            put(self._chips, "")
            put(self._values, "")
            return
        stage = str(progress["stage"]) if self.object else None
        passed = FILL_STAGES[: FILL_STAGES.index(stage)] if stage in FILL_STAGES else ()
        put(self._chips, boxed(chips([name.replace("_", " ") for name in FILL_STAGES],
            stage and stage.replace("_", " "), [name.replace("_", " ") for name in passed])))  # fmt: skip
        base, volume = self._fill
        put(self._values, facts([
            ("packed", f"{self._packed} of {len(progress['objects']) + self._to_come}"),
            ("base", f"{base:.0f} %"), ("volume", f"{volume:.0f} %"),
        ]))  # fmt: skip

    @property
    def _packed(self) -> int:
        return sum(bool(row["packed"]) for row in self._progress["objects"]) if self._progress else 0

    @property
    def _to_come(self) -> int:
        """How many objects are not done with, the one in work included."""
        in_work = bool(self.object or self._unfinished)
        return len(self._progress["to_come"]) + in_work if self._progress else 0

    @property
    def _fill(self) -> tuple[float, float]:
        """Shares of base and volume that objects take [%]."""
        fills = self._progress["fills"] if self._progress else ()
        return (100.0 * fills[-1][1], 100.0 * fills[-1][2]) if fills else (0.0, 0.0)

    def _rows(self) -> list[tuple[str, str, str]]:
        """The list's objects: sign, its colour, and text."""
        if self._progress is None:
            return []
        done = [
            ("✓", GREEN, str(row["name"])) if row["packed"] else ("✕", RED, f"{row['name']}: {row['reason']}")
            for row in self._progress["objects"]
        ]
        now = [("▶", ORANGE, self.object)] if self.object else []
        if self._unfinished:
            now = [("✕", RED, f"{self._unfinished}: not finished")]
        return [*done, *now, *(("·", GREY, str(name)) for name in self._progress["to_come"])]
