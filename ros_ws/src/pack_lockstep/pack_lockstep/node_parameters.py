"""The nodes' parameter files, for whoever composes the same cores without ROS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel

from pack_core.config import merged, validate_config
from pack_core.errors import ConfigError
from pack_core.parameter_fields import nested
from pack_core.paths import config_path
from pack_core.text.explanation import Layer
from pack_core.text.reader import load_yaml

C = TypeVar("C", bound=BaseModel)


def load_parameters(
    node: str, cls: type[C], over: Mapping[str, Any] | None = None, layers: Sequence[Layer] = ()
) -> C:
    """The part of `config/nodes/<cell>/<node>.yaml` that belongs to a core's configuration class.

    Args:
        node: cell and node, as in `packing/mpc`.
        cls: the class.
        over: values that override the file's, such as a preset's for this node; those of another core are
            passed over, as in the file.
        layers: files that these values come from, the uppermost first, for errors.

    Raises:
        ConfigError: the file is missing, is not of this node, or has a value that is not allowed.
    """
    parameters, source = parameters_of(node)
    if over:
        parameters, source = merged(parameters, over), f"{source} with a preset"
    return validate_config(
        cls, {key: parameters[key] for key in cls.model_fields if key in parameters}, source, layers=layers
    )


def parameters_of(node: str) -> tuple[dict[str, Any], str]:
    """All of `config/nodes/<node>.yaml`, e.g. of `packing/mpc`, and the file's name for errors.

    As for a ROS node, `section.key: value` means the same as `section: {key: value}`.

    Raises:
        ConfigError: the file is missing, is not of this node, or has a name for both a value and a section.
    """
    path, name = config_path("nodes", f"{node}.yaml"), node.rpartition("/")[2]
    parameters: Any = load_yaml(path)
    for key in (name, "ros__parameters"):
        parameters = parameters.get(key) if isinstance(parameters, dict) else None
    if not isinstance(parameters, dict):
        raise ConfigError(f"{path}: expected `{name}: ros__parameters:` at the top, with keys and values")
    try:
        # sections first, so that a dotted key adds to its section wherever it stands in the file
        return nested(dict(sorted(parameters.items(), key=lambda item: item[0].count(".")))), str(path)
    except (AttributeError, TypeError):  # the section is a number or a text
        raise ConfigError(f"{path}: a name stands both for a value and for a section of values") from None
