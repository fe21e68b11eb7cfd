"""ROS parameters from a configuration class: declared with its defaults, validated by it."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from pack_core.config import validate_config

C = TypeVar("C", bound=BaseModel)


def read_parameters(node: Node, cls: type[C]) -> C:
    """Declare every field of `cls` as a parameter and return the validated configuration.

    Nested configuration classes become dotted names.

    Raises:
        ConfigError: a parameter has a value that is not allowed.
    """
    return validate_config(cls, _declare(node, cls, ""), f"parameters of node '{node.get_name()}'")


def _declare(node: Node, cls: type[BaseModel], prefix: str) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for name, field in cls.model_fields.items():
        default = field.get_default(call_default_factory=True)
        if isinstance(default, BaseModel):
            values[name] = _declare(node, type(default), f"{prefix}{name}.")
            continue
        descriptor = ParameterDescriptor(description=field.description or "", dynamic_typing=True)
        plain = list(default) if isinstance(default, tuple) else default
        value = node.declare_parameter(prefix + name, plain, descriptor).value
        values[name] = list(value) if hasattr(value, "typecode") else value
    return values
