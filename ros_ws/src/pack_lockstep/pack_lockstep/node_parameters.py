"""The nodes' parameter files, for whoever composes the same cores without ROS."""

from __future__ import annotations

from typing import Any, TypeVar

import yaml
from pydantic import BaseModel

from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_core.paths import config_path

C = TypeVar("C", bound=BaseModel)


def load_parameters(node: str, cls: type[C]) -> C:
    """The part of `config/nodes/<cell>/<node>.yaml` that belongs to a core's configuration class.

    Raises:
        ConfigError: the file is missing, is not of this node, or has a value that is not allowed.
    """
    parameters, source = parameters_of(node)
    return validate_config(
        cls, {key: parameters[key] for key in cls.model_fields if key in parameters}, source
    )


def parameters_of(node: str) -> tuple[dict[str, Any], str]:
    """All of `config/nodes/<node>.yaml`, e.g. of `packing/mpc`, and the file's name for errors.

    Raises:
        ConfigError: the file is missing, or is not of this node.
    """
    path, name = config_path("nodes", f"{node}.yaml"), node.rpartition("/")[2]
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    try:
        return dict(yaml.safe_load(path.read_text())[name]["ros__parameters"]), str(path)
    except (KeyError, TypeError) as error:
        raise ConfigError(f"{path}: expected `{name}: ros__parameters:` at the top") from error
