"""What somebody does to a cell by hand while it works, and what becomes of it: the rows of one table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pack_core.errors import ConfigError


@dataclass(frozen=True)
class HandCase:
    """One thing that is done once.

    Attributes:
        what: what is done, as in "box turned".
        when: in which state of the cell.
    """

    what: str
    when: str

    @property
    def name(self) -> str:
        """As it is named in the file of results."""
        return f"{self.what}, {self.when}"


@dataclass(frozen=True)
class HandReport:
    """What became of it.

    Attributes:
        name: of the case.
        what: what was done.
        when: in which state.
        noticed: what the cell said of it, in the order in which it did; empty if nothing.
        noticed_after: from the hand to the first of these [s simulated]; `nan` if nothing was said.
        ended: how the order or the problem ended, in words.
        in_place: objects that are where they should be at the end, as "1 of 2".
        error_mm: largest error of those that the cell counts as placed [mm]; `nan` if there is none.
        angle_deg: the same of orientations [deg].
        touches: unwanted contacts.
        problem: why the case could not be tried; empty if it was.
    """

    name: str
    what: str
    when: str
    noticed: tuple[str, ...] = ()
    noticed_after: float = float("nan")
    ended: str = ""
    in_place: str = ""
    error_mm: float = float("nan")
    angle_deg: float = float("nan")
    touches: int = 0
    problem: str = ""


@dataclass(frozen=True)
class Hands:
    """A cell's part of `pack benchmark hands`.

    Attributes:
        cases: all of them, in the order of the table.
        run: tries one, with a seed.
        note: what the table's last columns mean in this cell.
    """

    cases: tuple[HandCase, ...]
    run: Callable[[HandCase, int], HandReport]
    note: str

    def wanted(self, what: Sequence[str], when: Sequence[str]) -> list[HandCase]:
        """The cases of some deeds in some states; all where none are named.

        Raises:
            ConfigError: there is no such deed or state.
        """
        for name, given, known in (
            ("deed", what, [case.what for case in self.cases]),
            ("state", when, [case.when for case in self.cases]),
        ):
            for text in given:
                if text not in known:
                    raise ConfigError(f"no {name} '{text}'; allowed: {', '.join(dict.fromkeys(known))}")
        return [
            case for case in self.cases if (not what or case.what in what) and (not when or case.when in when)
        ]


HAND_COLUMNS = (
    "state", "by hand", "noticed", "after [s]", "ended", "in place", "worst [mm]", "worst [deg]", "contacts",
)  # fmt: skip


def hand_row(report: Mapping[str, Any]) -> tuple[str, ...]:
    """A kept report as a row of the table."""

    def number(key: str, digits: int) -> str:
        value = report[key]  # text where it is not finite, as JSON has no other
        return "-" if isinstance(value, str) else f"{value:.{digits}f}"

    noticed = "; ".join(report["noticed"])
    return (
        report["when"], report["what"], report["problem"] or noticed or "nothing", number("noticed_after", 1),
        report["ended"], report["in_place"], number("error_mm", 1), number("angle_deg", 1),
        str(report["touches"]),
    )  # fmt: skip
