"""The line of a value in its text, for errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml

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
