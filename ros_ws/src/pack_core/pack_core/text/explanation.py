"""What pydantic refuses, in words: file, line, key, what was given, what is allowed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml
from pydantic import BaseModel, ValidationError

from pack_core.text.known_keys import meant
from pack_core.text.shown import listed, on_one_line, shown_value

LARGEST = 1_000_000
"""Texts longer than this are not searched: it would take longer than a second [characters]."""


class Lines:
    """Finds lines in a YAML or JSON text that was read already, so that it keeps to the limits."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._root: Any = None

    def of(self, keys: Sequence[Any]) -> int | None:
        """The line of the value that keys and places in lists lead to, or of the last one that is there.

        Parts that are no key of the text are passed over: pydantic puts names of kinds between them.
        """
        if self._root is None:
            self._root = self._composed()
        node, line = self._root, None
        for key in keys:
            child = _child(node, key)
            if child is not None:
                node, line = child
        return line

    def _composed(self) -> Any:
        if len(self._text) > LARGEST:
            return False
        try:
            # Nodes alone, no values; JSON is YAML, but for tabs.
            return yaml.compose(self._text, Loader=yaml.CSafeLoader) or False
        except (yaml.YAMLError, RecursionError, UnicodeError):
            return False


def _child(node: Any, key: Any) -> tuple[Any, int] | None:
    if isinstance(node, yaml.MappingNode):
        for name, value in node.value:
            if isinstance(name, yaml.ScalarNode) and name.value == str(key):
                return value, name.start_mark.line + 1
    elif isinstance(node, yaml.SequenceNode) and isinstance(key, int) and key < len(node.value):
        return node.value[key], node.value[key].start_mark.line + 1
    return None


def explanation(error: ValidationError, cls: type[BaseModel], source: str, text: str = "") -> str:
    """A line for every problem.

    Args:
        error: what pydantic raised.
        cls: the class that refused the values.
        source: names the text.
        text: the text itself, for the numbers of lines; empty: the values were not written in one text.
    """
    lines, found = Lines(text), error.errors(include_url=False)
    # what would follow from a value that is wrong itself is not wrong besides
    found = [item for item in found if item["type"] != "default_factory_not_called"]
    return listed([_explain(item, cls, source, lines) for item in found])


def _explain(item: Any, cls: type[BaseModel], source: str, lines: Lines) -> str:
    # pydantic: `loc` is the path of keys to the value, `type` what is wrong, `ctx` what is allowed.
    key = on_one_line(".".join(str(part) for part in item["loc"]))
    line = lines.of(item["loc"])
    place = source if line is None else f"{source}, line {line}"
    if item["type"] == "extra_forbidden":
        return f"{place}: key '{key}' is not known; {meant(cls, item['loc'])}"
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
