"""YAML text to values, built from the parser's events, so that every limit is checked as the text is read.

Allowed are mappings, lists, texts, numbers, `true`, `false` and nothing; a date is a text. Aliases are
allowed as long as all that they stand for stays below the limits. Refused are all other tags, keys that are
given twice, and several documents in one text.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml
from yaml.constructor import SafeConstructor
from yaml.resolver import Resolver

from pack_core.errors import ConfigError
from pack_core.text.limits import (
    LARGEST_INTEGER,
    MOST_BYTES,
    MOST_CHARACTERS_OF_NUMBER,
    MOST_DEPTH,
    MOST_VALUES,
    too_large,
)
from pack_core.text.shown import on_one_line, shown_value

TAG = "tag:yaml.org,2002:"
TEXTS = {f"{TAG}{kind}" for kind in ("str", "timestamp", "value")}
NUMBERS = {f"{TAG}{kind}" for kind in ("int", "float")}
OTHERS = {f"{TAG}{kind}" for kind in ("null", "bool")}
MERGE = f"{TAG}merge"


def parse_yaml(text: str, source: str) -> Any:
    """The values of YAML text; `source` names it in errors.

    Raises:
        ConfigError: the text is no YAML, or has what is not allowed; with the line.
    """
    if len(text) > MOST_BYTES:
        raise ConfigError(too_large(source, len(text)))
    try:
        return _Builder(text, source).document()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f", line {mark.line + 1}" if mark else ""
        problem = on_one_line(str(error.problem or error.context))
        raise ConfigError(f"{source}{line}: not readable as YAML: {problem}") from error
    except (yaml.YAMLError, UnicodeError) as error:
        problem = on_one_line(str(error).splitlines()[0])
        raise ConfigError(f"{source}: not readable as YAML: {problem}") from error


class _Builder:
    """Builds values from the events of one text."""

    def __init__(self, text: str, source: str) -> None:
        self._events: Iterator[Any] = yaml.parse(text, Loader=yaml.CSafeLoader)
        self._source = source
        self._resolver: Any = Resolver()  # untyped in PyYAML
        self._constructor = SafeConstructor()
        self._anchors: dict[str, tuple[Any, int]] = {}  # by name: the value, and how many values it holds
        self._count = 0

    def document(self) -> Any:
        next(self._events)  # the stream's start
        if isinstance(next(self._events), yaml.StreamEndEvent):
            return None
        values = self._value(next(self._events), 0)
        next(self._events)  # the document's end
        if not isinstance(after := next(self._events), yaml.StreamEndEvent):
            raise self._refusal(after, "a second document begins; allowed: one")
        return values

    def _value(self, event: Any, depth: int) -> Any:
        if depth > MOST_DEPTH:
            raise self._refusal(event, f"deeper than {MOST_DEPTH} levels; allowed: fewer")
        before = self._count
        self._add(event, 1)
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event)
        if isinstance(event, yaml.ScalarEvent):
            value = self._scalar(event)
        elif isinstance(event, yaml.SequenceStartEvent):
            self._check_tag(event, "seq")
            value = self._items(depth)
        else:
            self._check_tag(event, "map")
            value = self._mapping(depth)
        if event.anchor:
            self._anchors[event.anchor] = (value, self._count - before)
        return value

    def _alias(self, event: Any) -> Any:
        if event.anchor not in self._anchors:
            name = on_one_line(event.anchor)
            raise self._refusal(event, f"alias '*{name}' has no '&{name}' that ends before it")
        value, count = self._anchors[event.anchor]
        self._add(event, count)
        return value

    def _items(self, depth: int) -> list[Any]:
        items = []
        while not isinstance(event := next(self._events), yaml.SequenceEndEvent):
            items.append(self._value(event, depth + 1))
        return items

    def _mapping(self, depth: int) -> dict[Any, Any]:
        values: dict[Any, Any] = {}
        merged: list[Any] = []
        while not isinstance(event := next(self._events), yaml.MappingEndEvent):
            if not isinstance(event, yaml.ScalarEvent):
                raise self._refusal(event, "a key is a list, a mapping or an alias; allowed: a name")
            if self._tag(event) == MERGE:
                merged += self._merged(next(self._events), depth)
                continue
            self._add(event, 1)
            key = self._scalar(event)
            if key in values:
                raise self._refusal(event, f"key '{on_one_line(str(key))}' is given twice; allowed: once")
            values[key] = self._value(next(self._events), depth + 1)
        for more in merged:
            values = {**more, **values}
        return values

    def _merged(self, event: Any, depth: int) -> list[dict[Any, Any]]:
        """The mappings that `<<:` names; the first has precedence."""
        value = self._value(event, depth + 1)
        found = value if isinstance(value, list) else [value]
        if not all(isinstance(item, dict) for item in found):
            raise self._refusal(event, f"'<<' is {shown_value(value)}; allowed: mappings")
        return found

    def _scalar(self, event: Any) -> Any:
        tag = self._tag(event)
        if tag in TEXTS:
            return event.value
        if tag not in NUMBERS | OTHERS:
            raise self._refusal(event, f"tag '{on_one_line(tag)}' is not allowed; leave it out")
        if len(event.value) > MOST_CHARACTERS_OF_NUMBER:
            most = MOST_CHARACTERS_OF_NUMBER
            raise self._refusal(event, f"a number of {len(event.value)} characters; allowed: up to {most}")
        try:
            node = yaml.ScalarNode(tag, event.value, event.start_mark, event.end_mark)
            value = SafeConstructor.yaml_constructors[tag](self._constructor, node)
        except (ValueError, LookupError, OverflowError) as error:
            kind = tag.removeprefix(TAG)
            raise self._refusal(event, f"{shown_value(event.value)} is not of the type {kind}") from error
        if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            raise self._refusal(event, f"{shown_value(value)} is too large; allowed: 64 bits")
        return value

    def _tag(self, event: Any) -> str:
        if event.tag is not None and event.tag != "!":
            return str(event.tag)
        return str(self._resolver.resolve(yaml.ScalarNode, event.value, event.implicit))

    def _check_tag(self, event: Any, kind: str) -> None:
        if event.tag not in (None, "!", f"{TAG}{kind}"):
            raise self._refusal(event, f"tag '{on_one_line(event.tag)}' is not allowed; leave it out")

    def _add(self, event: Any, count: int) -> None:
        self._count += count
        if self._count > MOST_VALUES:
            raise self._refusal(event, f"more than {MOST_VALUES} values, aliases in full; allowed: fewer")

    def _refusal(self, event: Any, problem: str) -> ConfigError:
        return ConfigError(f"{self._source}, line {event.start_mark.line + 1}: {problem}")
