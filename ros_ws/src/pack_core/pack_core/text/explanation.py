"""What pydantic refuses, in words: file, line, key, what was given, what is allowed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml
from pydantic import BaseModel, ValidationError

from pack_core.text.known_keys import meant
from pack_core.text.shown import listed, on_one_line, shown_value

SHAPES = {
    "dict_type": "keys and values", "model_type": "keys and values",
    "model_attributes_type": "keys and values", "list_type": "a list", "tuple_type": "a list",
}  # fmt: skip
"""What a value has to be, in the words of the files, where pydantic names a class of Python's."""
LARGEST = 1_000_000
"""Texts longer than this are not searched: it would take longer than a second [characters]."""


@dataclass(frozen=True)
class Layer:
    """Values that lie over others, as a preset's over those of a configuration file.

    Attributes:
        source: names the text in errors.
        text: YAML that has the values.
        section: the key below which it has them.
        is_file: whether the text is that of a file, so that its lines say something.
    """

    source: str
    text: str
    section: str
    is_file: bool = True

    def place(self, keys: Sequence[Any]) -> str | None:
        """File and line of the value that all the keys lead to; None: the layer has no such value."""
        line = Lines(self.text).exactly((self.section, *keys))
        if line is None:
            return None
        return f"{self.source}, line {line}" if self.is_file else self.source


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

    def exactly(self, keys: Sequence[Any]) -> int | None:
        """The line of the value that all of the keys and places in lists lead to; None: there is none."""
        node, line = self._composed(), None
        for key in keys:
            child = _child(node, key)
            if child is None:
                return None
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


def explanation(
    error: ValidationError, cls: type[BaseModel], source: str, text: str = "", *, data: Any = None,
    layers: Sequence[Layer] = (),
) -> str:  # fmt: skip
    """A line for every problem.

    Args:
        error: what pydantic raised.
        cls: the class that refused the values.
        source: names the text.
        text: the text itself, for the numbers of lines; empty: the values were not written in one text.
        data: the values, those of all layers together.
        layers: what lies over the text, the uppermost first; a problem is told of the one that has its value.
    """
    lines, found = Lines(text), error.errors(include_url=False)
    # what would follow from a value that is wrong itself is not wrong besides
    found = [item for item in found if item["type"] != "default_factory_not_called"]
    return listed([_explain(item, cls, _place(item["loc"], source, lines, data, layers)) for item in found])


def _place(loc: Sequence[Any], source: str, lines: Lines, data: Any, layers: Sequence[Layer]) -> str:
    """Where a value stands: in the uppermost layer that has it, else in the text."""
    keys = _leading(data, loc)
    if keys and (places := [place for layer in layers if (place := layer.place(keys))]):
        return places[0]
    line = lines.of(loc)
    return source if line is None else f"{source}, line {line}"


def _leading(data: Any, loc: Sequence[Any]) -> list[Any]:
    """The parts of `loc` that are there, without what is missing and pydantic's names of kinds."""
    keys = []
    for key in loc:
        if isinstance(data, list | tuple):
            is_there = isinstance(key, int) and key < len(data)
        else:
            is_there = isinstance(data, Mapping) and key in data
        if is_there:
            data = data[key]
            keys.append(key)
    return keys


def _explain(item: Any, cls: type[BaseModel], place: str) -> str:
    # pydantic: `loc` is the path of keys to the value, `type` what is wrong, `ctx` what is allowed.
    key = on_one_line(".".join(str(part) for part in item["loc"]))
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
    return refusal(place, key, item)


def refusal(place: str, key: str, item: Any) -> str:
    """What one value was given as, and what is allowed instead.

    Args:
        place: where the value stands.
        key: of the value; empty: it is the whole.
        item: one of the errors that pydantic raised.
    """
    if key:
        return f"{place}: key '{key}' is {shown_value(item['input'])}; allowed: {allowed_words(item)}"
    if item["type"] in SHAPES:
        return f"{place} is {shown_value(item['input'])}; allowed: {allowed_words(item)}"
    return f"{place}: {allowed_words(item)}"  # a check of the whole, which says itself what is wrong


def allowed_words(item: Any) -> str:
    """What is allowed instead of a value that pydantic refused, such as "greater than 0"."""
    words: str = item["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    return SHAPES.get(item["type"], words)
