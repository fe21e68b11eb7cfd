"""What is done to a cell from outside while it works, and what becomes of it: the rows of one table.

Faults of the nodes of a running cell are chosen in the same way (`chosen`) and kept in the same kind of file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pack_core.errors import ConfigError


@dataclass(frozen=True)
class Disturbance:
    """One change to the cell that is made once, without its knowledge.

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
class DisturbanceReport:
    """What became of a disturbed run.

    Attributes:
        name: of the case.
        what: what was done.
        when: in which state.
        noticed: what the cell said of it, in the order in which it did; empty if nothing.
        noticed_after: from the disturbance to the first of these [s simulated]; `nan` if nothing was said.
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
class DisturbanceTable:
    """A cell's part of `pack benchmark hands`.

    Attributes:
        cases: all of them, in the order of the table.
        run: tries one, with a seed.
        note: what the table's last columns mean in this cell.
    """

    cases: tuple[Disturbance, ...]
    run: Callable[[Disturbance, int], DisturbanceReport]
    note: str


CaseT = TypeVar("CaseT")


def chosen(cases: Sequence[CaseT], **given: tuple[str, Sequence[str]]) -> list[CaseT]:
    """The cases that have one of the given values in each attribute.

    Args:
        cases: all of them.
        given: by attribute, what it is called in an error, and the values that are wanted; none: any.

    Raises:
        ConfigError: no case has a given value.
    """
    for attribute, (what, values) in given.items():
        known = dict.fromkeys(str(getattr(case, attribute)) for case in cases)
        for value in values:
            if value not in known:
                raise ConfigError(f"no {what} '{value}'; allowed: {', '.join(known)}")
    return [
        case
        for case in cases
        if all(not values or getattr(case, name) in values for name, (_, values) in given.items())
    ]


DISTURBANCE_COLUMNS = (
    "state", "by hand", "noticed", "after [s]", "ended", "in place", "worst [mm]", "worst [deg]", "contacts",
)  # fmt: skip


def disturbance_row(report: Mapping[str, Any]) -> tuple[str, ...]:
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
