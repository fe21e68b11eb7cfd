"""What pydantic refuses, in words: file, line, key, what was given, what is allowed."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from pack_core.text.lines import Lines
from pack_core.text.shown import listed, on_one_line, shown_value


def explanation(error: ValidationError, source: str, text: str = "") -> str:
    """A line for every problem.

    Args:
        error: what pydantic raised.
        source: names the text.
        text: the text itself, for the numbers of lines; empty: the values were not written in one text.
    """
    lines = Lines(text)
    return listed([_explain(item, source, lines) for item in error.errors(include_url=False)])


def _explain(item: Any, source: str, lines: Lines) -> str:
    # pydantic: `loc` is the path of keys to the value, `type` what is wrong, `ctx` what is allowed.
    key = on_one_line(".".join(str(part) for part in item["loc"]))
    line = lines.of(item["loc"])
    place = source if line is None else f"{source}, line {line}"
    if item["type"] == "extra_forbidden":
        return f"{place}: key '{key}' is not known; remove it or correct its spelling"
    if item["type"] == "missing":
        return f"{place}: key '{key}' is missing"
    # Sections of several kinds are told apart by one key, which pydantic names in quotes.
    discriminator = item.get("ctx", {}).get("discriminator", "").strip("'")
    if item["type"] == "union_tag_not_found":
        return f"{place}: key '{key}.{discriminator}' is missing"
    if item["type"] == "union_tag_invalid":
        tag, allowed = on_one_line(str(item["ctx"]["tag"])), item["ctx"]["expected_tags"]
        return f"{place}: key '{key}.{discriminator}' is '{tag}'; allowed: {allowed}"
    message = item["msg"].removeprefix("Value error, ")
    if not key:
        return f"{place}: {message}"
    return f"{place}: key '{key}' is {shown_value(item['input'])}; allowed: {message}"
