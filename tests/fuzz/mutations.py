"""Makes broken and strange variants of a file: by structure, as text, and byte by byte."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import yaml

NUMBERS = (
    float("nan"), float("inf"), -float("inf"), 0, -0.0, -1, 1e-300, 1e-16, 1e18, 1e300, 2**63, 10**400, 1.009,
)  # fmt: skip
TEXTS = (
    "", "a" * 200_000, "../../etc/passwd", "\x1b[2J\x1b[31mred", "a\nb", "<script>alert(1)</script>",
    "[bold red]x[/]", "$\\frac{", "ünï", "\u202edrowssap", "0.4", "nan", "{cell}", "%s%n", "world", "\x00",
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    *NUMBERS,
    *TEXTS,
    None,
    True,
    False,
    [],
    {},
    [[[[[]]]]],
    {"a": {"b": 1}},
    list(range(2000)),
)
LINES = (
    "x: !!python/object/apply:os.system ['true']", "x: !!int spam", "x: 2001-99-99", "x: 0x_", 'x: "\\ud800"',
    "x: !!binary abc", "x: !!timestamp 99999-01-01", "x: &a [*a]", "<<: 5", "? [a, b]\n: 1", "? {a: 1}\n: 2",
    "x: !!float _", "\tx: 1", "x: *none", "--- \n--- \n", "%YAML 9.9", "x: !!set {a, b}", "x: !!omap [a: 1]",
    "x: 1:60:60.5", "x: .inf", "x: !!null spam", "x: !!bool spam", "x: '\\U0011FFFF'", "=: 1",
    "x: !unknown 3",
)  # fmt: skip
BOMB = "\n".join(
    ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    + [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 12)]
)


def mutated(data: bytes, kind: str, rng: random.Random) -> bytes:
    """A variant of a file's content.

    Args:
        data: the content of a sound file.
        kind: "yaml", "json" or "binary".
        rng: decides on the variant.
    """
    if kind == "binary":
        return _bytes(data, rng)
    if rng.random() < 0.5:
        return _structure(data.decode(), kind, rng)
    return _text(data.decode(), kind, rng)


def _structure(text: str, kind: str, rng: random.Random) -> bytes:
    values = json.loads(text) if kind == "json" else yaml.safe_load(text)
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        values = changed(values, rng)
    if kind == "json":
        try:
            return json.dumps(values).encode()
        except ValueError:  # an integer of more digits than Python prints
            return b"[" + b"9" * 5000 + b"]"
    try:
        return str(yaml.safe_dump(values, allow_unicode=rng.random() < 0.5)).encode("utf-8", "surrogatepass")
    except ValueError:
        return b"x: " + b"9" * 5000


def changed(values: Any, rng: random.Random) -> Any:
    """A copy of nested lists and mappings with one place in it replaced, removed, doubled or added to."""
    values = deepcopy(values)
    holder, key = _place(values, rng)
    if holder is None:
        return rng.choice(VALUES)
    action = rng.randrange(6)
    if action <= 2:
        holder[key] = _strange(holder[key], rng)
    elif action == 3:
        del holder[key]
    elif action == 4 and isinstance(holder, list):
        holder.extend([deepcopy(holder[key])] * rng.choice((1, 3, 1200)))
    else:
        other = rng.choice((*TEXTS, 5, None, 1.5))
        if isinstance(holder, dict):
            holder[other if rng.random() < 0.7 else "extra"] = rng.choice(VALUES)
        else:
            holder.insert(0, rng.choice(VALUES))
    return values


def _place(values: Any, rng: random.Random) -> tuple[Any, Any]:
    """A random list or mapping in `values`, and a key of it; deep places are as likely as shallow ones."""
    places: list[tuple[Any, Any]] = []

    def gather(item: Any) -> None:
        keys = list(item) if isinstance(item, dict) else range(len(item)) if isinstance(item, list) else ()
        for key in keys:
            places.append((item, key))
            gather(item[key])

    gather(values)
    return rng.choice(places) if places else (None, None)


def _strange(value: Any, rng: random.Random) -> Any:
    if isinstance(value, (int, float)) and rng.random() < 0.7:
        factor = rng.choice((0.0, -1.0, 1e-6, 0.5, 0.99, 1.01, 2.0, 10.0, 1e6))
        if abs(value) > 1e300:  # products of the largest integers do not fit into a float
            return rng.choice(NUMBERS)
        return rng.choice((*NUMBERS, value * factor, value + rng.uniform(-0.3, 0.3), str(value), bool(value)))
    return rng.choice(VALUES)


def _text(text: str, kind: str, rng: random.Random) -> bytes:
    changes: tuple[Callable[[], bytes], ...] = (
        lambda: ("# é ü\n" + text).encode("latin-1", "replace"),
        lambda: text.encode("utf-16"),
        lambda: b"\xef\xbb\xbf" + text.encode(),
        lambda: text[: rng.randrange(len(text) + 1)].encode(),
        lambda: _bytes(text.encode(), rng),
        lambda: _bytes(text.encode(), rng),
        lambda: _line_added(text, rng.choice(LINES), rng),
        lambda: _line_added(text, rng.choice(LINES), rng),
        lambda: _line_doubled(text, rng),
        lambda: _line_doubled(text, rng),
        lambda: ("[" * 1000 + "]" * 1000).encode(),
        lambda: ("x: " + "{a: " * 1000 + "1" + "}" * 1000).encode(),
        lambda: _deep_json(rng.choice((100, 1000, 100_000))),
        lambda: (BOMB + "\n" + text).encode(),
        lambda: _token_replaced(text, rng),
        lambda: _token_replaced(text, rng),
        lambda: _token_replaced(text, rng),
        lambda: (text + "\n# " + "x" * rng.choice((10, 3_000_000, 30_000_000))).encode(),
        lambda: b"",
    )
    return rng.choice(changes)()


def _deep_json(depth: int) -> bytes:
    return b'{"a":' * depth + b"1" + b"}" * depth


def _line_added(text: str, line: str, rng: random.Random) -> bytes:
    lines = text.splitlines()
    place = rng.choice((0, len(lines), rng.randrange(len(lines) + 1)))
    return "\n".join([*lines[:place], line, *lines[place:]]).encode("utf-8", "surrogatepass")


def _line_doubled(text: str, rng: random.Random) -> bytes:
    lines = text.splitlines() or [""]
    k = rng.randrange(len(lines))
    return "\n".join([*lines[: k + 1], *lines[k:]]).encode()


def _token_replaced(text: str, rng: random.Random) -> bytes:
    """One number or word of the text replaced by another spelling that readers may not expect."""
    tokens = text.split(" ")
    k = rng.randrange(len(tokens))
    tokens[k] = rng.choice(
        ("NaN", ".nan", "1e999", "-", "0o7", "1_000", "!!str", "yes", "~", "'", '"', "9" * 400, "{")
    )
    return " ".join(tokens).encode()


def _bytes(data: bytes, rng: random.Random) -> bytes:
    changed = bytearray(data)
    if not changed:
        return b"\x00"
    action = rng.randrange(5)
    start = rng.randrange(len(changed))
    if action == 0:
        return bytes(changed[:start])
    if action == 1:  # eight bytes that may be a length
        changed[start : start + 8] = rng.choice(
            (b"\xff" * 8, b"\x00" * 8, b"\x00\x00\x00\x7f\x00\x00\x00\x00")
        )
    elif action == 2:
        del changed[start : start + rng.randrange(1, 50)]
    elif action == 3:
        changed[start:start] = changed[start : start + rng.randrange(1, 200)]
    else:
        for _ in range(rng.choice((1, 1, 5, 50))):
            changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)
