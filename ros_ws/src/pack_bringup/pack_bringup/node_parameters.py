"""The nodes' parameter files, for whoever composes the same cores without ROS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel

from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_core.paths import config_path

C = TypeVar("C", bound=BaseModel)


def load_parameters(node: str, cls: type[C]) -> C:
    """The part of `config/nodes/<node>.yaml` that belongs to a core's configuration class.

    Raises:
        ConfigError: the file is missing, is not of this node, or has a value that is not allowed.
    """
    parameters, source = parameters_of(node)
    return validate_config(
        cls, {key: parameters[key] for key in cls.model_fields if key in parameters}, source
    )


def parameters_of(node: str) -> tuple[dict[str, Any], str]:
    """All of `config/nodes/<node>.yaml`, and the file's name for errors.

    Raises:
        ConfigError: the file is missing, or is not of this node.
    """
    path = config_path("nodes", f"{node}.yaml")
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    try:
        return dict(yaml.safe_load(path.read_text())[node]["ros__parameters"]), str(path)
    except (KeyError, TypeError) as error:
        raise ConfigError(f"{path}: expected `{node}: ros__parameters:` at the top") from error


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
