"""Configuration files: frozen, validated, and unforgiving of unknown keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from pack_core.errors import ConfigError


class Config(BaseModel):
    """Base of every configuration class."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=True)


C = TypeVar("C", bound=BaseModel)


def load_config(cls: type[C], path: Path) -> C:
    """Read a YAML file into a configuration class.

    Raises:
        ConfigError: the file is missing, is not YAML, or has a key or value that is not allowed.
    """
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    return parse_config(cls, path.read_text(), str(path))


def parse_config(cls: type[C], text: str, source: str) -> C:
    """Read YAML text into a configuration class; `source` names it in errors."""
    try:
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise ConfigError(f"{source}: not readable as YAML: {error}") from error
    return validate_config(cls, data, source)


def validate_config(cls: type[C], data: Any, source: str) -> C:
    """Turn plain data into a configuration class; `source` names it in errors."""
    if not isinstance(data, dict):
        raise ConfigError(f"{source}: expected keys and values, got {type(data).__name__}")
    try:
        return cls.model_validate(data)
    except ValidationError as error:
        raise ConfigError("\n".join(_explain(item, source) for item in error.errors())) from error


def _explain(item: Any, source: str) -> str:
    key = ".".join(str(part) for part in item["loc"])
    if item["type"] == "extra_forbidden":
        return f"{source}: key '{key}' is not known; remove it or correct its spelling"
    if item["type"] == "missing":
        return f"{source}: key '{key}' is missing"
    discriminator = item.get("ctx", {}).get("discriminator", "").strip("'")
    if item["type"] == "union_tag_not_found":
        return f"{source}: key '{key}.{discriminator}' is missing"
    if item["type"] == "union_tag_invalid":
        tag, allowed = item["ctx"]["tag"], item["ctx"]["expected_tags"]
        return f"{source}: key '{key}.{discriminator}' is '{tag}'; allowed: {allowed}"
    message = item["msg"].removeprefix("Value error, ")
    if not key:
        return f"{source}: {message}"
    return f"{source}: key '{key}' is {item['input']!r}; allowed: {message}"
