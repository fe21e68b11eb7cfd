"""Text from outside, made fit to be shown: no control characters, no endless lines."""

from __future__ import annotations

from reprlib import Repr
from typing import Any

LONGEST_VALUE = 60
LONGEST_LINE = 2000
"""Characters of a value, and of a whole line, that are shown."""
MOST_LINES = 20
"""Problems that an error lists."""


class _Short(Repr):
    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = self.maxlong = LONGEST_VALUE
        self.maxlevel = 3


def shown_value(value: Any) -> str:
    """A value as Python writes it, cut to a length that fits into a line."""
    text = _Short().repr(value)
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 3] + "..."


def printable(text: str) -> str:
    r"""Text whose control characters, terminal escapes and marks of direction are written as `\\x1b`.

    Line breaks stay; a line longer than `LONGEST_LINE` is cut.
    """
    return "\n".join(_cut(_escaped(line)) for line in text.split("\n"))


def on_one_line(text: str) -> str:
    """The same for a name or key, which has no line breaks to keep."""
    return _cut(_escaped(text))


def listed(problems: list[str]) -> str:
    """A line for every problem, and how many more there are beyond `MOST_LINES`."""
    more = len(problems) - MOST_LINES
    return "\n".join(problems[:MOST_LINES] + ([f"and {more} more problems"] if more > 0 else []))


def _escaped(text: str) -> str:
    # `isprintable` is false for controls, surrogates and the marks that turn the direction of writing
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in text)


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_LINE else text[: LONGEST_LINE - 3] + "..."
