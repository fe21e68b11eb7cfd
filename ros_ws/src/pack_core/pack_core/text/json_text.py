"""JSON text to values, under the same limits as YAML."""

from __future__ import annotations

import json
import re
from typing import Any

from pack_core.errors import ConfigError
from pack_core.text.limits import (
    LARGEST_INTEGER,
    MOST_BYTES,
    MOST_CHARACTERS_OF_NUMBER,
    MOST_DEPTH,
    MOST_VALUES,
    too_large,
)
from pack_core.text.shown import on_one_line

HALF_SIGN = re.compile(r"\\u[dD][89abAB]|\\u[dD][c-fC-F]")


def parse_json(text: str, source: str) -> Any:
    """The values of JSON text; `source` names it in errors.

    NaN and Infinity are read as numbers: whoever checks a value by its key refuses them by its name.

    Raises:
        ConfigError: the text is no JSON, or has what is not allowed.
    """
    if len(text) > MOST_BYTES:
        raise ConfigError(too_large(source, len(text)))
    try:
        values = json.loads(text, object_pairs_hook=_mapping, parse_int=_integer)
    except json.JSONDecodeError as error:
        raise ConfigError(f"{source}, line {error.lineno}: is no JSON: {error.msg}") from error
    except RecursionError as error:
        raise ConfigError(f"{source}: {_too_deep()}") from error
    except ValueError as error:  # of the two functions below
        raise ConfigError(f"{source}: {error}") from error
    if problem := _beyond_limits(values) or _half_signs(text, values):
        raise ConfigError(f"{source}: {problem}")
    return values


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        keys = [key for key, _ in pairs]
        doubled = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"key '{on_one_line(doubled)}' is given twice; allowed: once")
    return values


def _integer(digits: str) -> int:
    if len(digits) > MOST_CHARACTERS_OF_NUMBER or abs(value := int(digits)) > LARGEST_INTEGER:
        raise ValueError(f"a number begins with {digits[:12]} and has {len(digits)} digits; allowed: 64 bits")
    return value


def _beyond_limits(values: Any) -> str:
    """What is too deep or too much; empty if nothing is."""
    count, level = 0, [values]
    for _ in range(MOST_DEPTH + 2):
        count += len(level)
        if count > MOST_VALUES:
            return f"more than {MOST_VALUES} values; allowed: fewer"
        level = [item for holder in level for item in _items(holder)]
        if not level:
            return ""
    return _too_deep()


def _half_signs(text: str, values: Any) -> str:
    r"""What is wrong with escapes such as `\ud800`, half of a sign; empty if nothing is."""
    if not HALF_SIGN.search(text):
        return ""
    try:
        json.dumps(values, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return "a text holds half of a sign, \\ud800 to \\udfff; allowed: both halves"
    return ""


def _items(holder: Any) -> list[Any]:
    if isinstance(holder, dict):
        return list(holder.values())
    return holder if isinstance(holder, list) else []


def _too_deep() -> str:
    return f"deeper than {MOST_DEPTH} levels; allowed: fewer"
