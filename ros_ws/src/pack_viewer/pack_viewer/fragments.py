"""Small pieces of HTML, in which every text that comes from outside is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

# Okabe and Ito's palette, which colour-blind people tell apart; signs beside it say the same.
BLUE, ORANGE, GREEN, RED, PURPLE, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#808890"
FONT = "font:14px/1.45 system-ui,sans-serif;font-variant-numeric:tabular-nums"
WIDTH = "padding:0 .75em .25em"
"""viser gives its own widgets such a margin, but not what is HTML."""


def headline(title: str, note: str = "", colour: str = "inherit") -> str:
    """The state in large letters, with a line below it."""
    return (
        f'<div style="{FONT};{WIDTH}"><div role="status" style="font-size:1.45em;font-weight:650;'
        f'color:{colour}">{escape(title)}</div>{lines([note])}</div>'
    )


def lines(texts: Iterable[str], colour: str = "inherit") -> str:
    """Texts below each other; empty ones are left out."""
    return "".join(f'<div style="color:{colour}">{escape(text)}</div>' for text in texts if text)


def facts(rows: Iterable[tuple[str, str]]) -> str:
    """Names and values, a row each."""
    cells = "".join(
        f'<div style="opacity:.7">{escape(name)}</div>'
        f'<div style="overflow-wrap:anywhere">{escape(value)}</div>'
        for name, value in rows
    )
    return (
        f'<div style="{FONT};{WIDTH};display:grid;grid-template-columns:minmax(6.5em,auto) 1fr;'
        f'column-gap:.8em">{cells}</div>'
    )


def signed_list(rows: Iterable[tuple[str, str, str]], empty: str = "") -> str:
    """A list whose entries begin with a sign: sign, its colour, text, which may have several lines."""
    items = [
        f'<div><span style="color:{colour};font-weight:700">{escape(sign)}</span> {escape(text)}</div>'
        for sign, colour, text in rows
    ]
    body = "".join(items) or f'<div style="opacity:.7">{escape(empty)}</div>'
    return f'<div style="{FONT};{WIDTH};overflow-wrap:anywhere;white-space:pre-line">{body}</div>'


def chips(
    names: Sequence[str], current: str | None, visited: Iterable[str] = (), failed: Iterable[str] = ()
) -> str:
    """Names in a row, of which the current one is lit and those passed are ticked."""
    passed, wrong = set(visited), set(failed)
    return "".join(_chip(name, name == current, name in passed, name in wrong) for name in names)


def _chip(name: str, is_current: bool, is_visited: bool, is_failed: bool) -> str:
    colour, sign = GREY, ""
    if is_visited:
        colour, sign = GREEN, "✓ "
    if is_failed:
        colour, sign = RED, "✕ "
    fill = f"background:{ORANGE};color:#111;" if is_current else ""
    sign = "▶ " if is_current else sign
    current = ' aria-current="step"' if is_current else ""
    return (
        f'<span{current} style="{fill}display:inline-block;border:1.5px solid {colour};border-radius:5px;'
        f'padding:1px 6px;margin:2px 3px 2px 0;white-space:nowrap">{sign}{escape(name)}</span>'
    )


def boxed(inner: str) -> str:
    """Pieces made here, with the font and the margin of the page."""
    return f'<div style="{FONT};{WIDTH}">{inner}</div>'


def put(handle: Any, content: str) -> None:
    """Show HTML in a widget of the page; it is sent only if it is not there already."""
    if handle.content != content:
        handle.content = content
