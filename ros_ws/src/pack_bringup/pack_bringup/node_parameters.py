"""The nodes' parameter files, for whoever composes the same cores without ROS."""

from __future__ import annotations

from typing import TypeVar

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
    path = config_path("nodes", f"{node}.yaml")
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    try:
        parameters = yaml.safe_load(path.read_text())[node]["ros__parameters"]
    except (KeyError, TypeError) as error:
        raise ConfigError(f"{path}: expected `{node}: ros__parameters:` at the top") from error
    return validate_config(
        cls, {key: parameters[key] for key in cls.model_fields if key in parameters}, str(path)
    )
