"""Configuration files: frozen, validated, and unforgiving of unknown keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from pack_core.errors import ConfigError
from pack_core.text.explanation import Layer, explanation
from pack_core.text.reader import read_text
from pack_core.text.yaml_text import parse_yaml


class Config(BaseModel):
    """Base of every configuration class."""

    # Infinity is allowed because it switches a limit off, as in `force_stop: .inf`.
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=True)


@dataclass(frozen=True)
class Changeable:
    """Marks fields whose values may be changed while their node runs.

    It stands in the annotation of a field, `Annotated[float, AT_ONCE]`; of a section, whose fields all have
    it then; or as the class variable `changeable` of a configuration class, for the fields that this class
    declares. A field without it is read when the node starts, and is read-only from then on.

    Attributes:
        when: from when on a new value counts, in words.
    """

    when: str


AT_ONCE = Changeable("at once")
NEXT_REQUEST = Changeable("from the next request on")
NEXT_GOAL = Changeable("from the next goal on")

C = TypeVar("C", bound=BaseModel)

FOLDER = "folder"
"""Key of pydantic's validation context: the folder of the files that values name."""


def load_config(cls: type[C], path: Path) -> C:
    """Read a YAML file into a configuration class.

    Raises:
        ConfigError: the file is missing, is not YAML, or has a key or value that is not allowed.
    """
    return parse_config(cls, read_text(path), str(path), path.parent)


def parse_config(cls: type[C], text: str, source: str, folder: Path | None = None) -> C:
    """Read YAML text into a configuration class.

    Args:
        cls: the class.
        text: the text.
        source: names it in errors.
        folder: where files are that the text names; None: it may name none.
    """
    return validate_config(cls, parse_values(text, source), source, text, folder)


def load_values(path: Path) -> dict[str, Any]:
    """Keys and values of a YAML file; raises ConfigError."""
    return parse_values(read_text(path), str(path))


def parse_values(text: str, source: str) -> dict[str, Any]:
    """Keys and values of YAML text; `source` names it in errors."""
    data = parse_yaml(text, source)
    if not isinstance(data, dict):
        raise ConfigError(f"{source}: expected keys and values, got {type(data).__name__}")
    return data


def merged(values: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """`values` with those of `over` in their place; sections are merged, all else is replaced."""
    result = dict(values)
    for key, value in over.items():
        old = result.get(key)
        if isinstance(old, Mapping) and isinstance(value, Mapping):
            result[key] = merged(old, value)
        else:
            result[key] = value
    return result


def validate_config(
    cls: type[C], data: Mapping[str, Any], source: str, text: str = "", folder: Path | None = None,
    layers: Sequence[Layer] = (),
) -> C:  # fmt: skip
    """Turn keys and values into a configuration class.

    Args:
        cls: the class.
        data: keys and values.
        source: names them in errors.
        text: the text that `data` was read from, for the numbers of lines; empty: from no single one.
        folder: where files are that the values name; None: they may name none.
        layers: of `data`, what lies over the source, the uppermost first: errors name the one with the value.
    """
    try:
        return cls.model_validate(data, context={FOLDER: folder})
    except ValidationError as error:
        raise ConfigError(explanation(error, cls, source, text, data=data, layers=layers)) from error
