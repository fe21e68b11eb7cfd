"""ROS parameters from a configuration class: declared with its defaults, validated by it."""

from __future__ import annotations

from difflib import get_close_matches
from types import UnionType
from typing import Any, TypeVar, get_args

from pydantic import BaseModel
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from pack_core.config import validate_config

C = TypeVar("C", bound=BaseModel)


def read_parameters(node: Node, cls: type[C]) -> C:
    """Declare every field of `cls` as a parameter and return the validated configuration.

    Nested configuration classes become dotted names; a section that may be None is there as soon as
    one of its parameters is given.

    Raises:
        ConfigError: a parameter has a value that is not allowed.
    """
    return validate_config(cls, _declare(node, cls, ""), f"parameters of node '{node.get_name()}'")


def unknown_parameters(node: Node) -> list[str]:
    """Parameters that were given to the node and that it does not have, each in words.

    To be called once all parameters are declared.
    """
    given: dict[str, Any] = node._parameter_overrides  # rclpy has no public name for it
    known = [name for name in node.get_parameters_by_prefix("") if name not in given]
    said = []
    for name in given:
        if not node.has_parameter(name):
            nearest = get_close_matches(name, known, n=1)
            said.append(f"'{name}'" + (f"; did you mean '{nearest[0]}'?" if nearest else ""))
    return said


def _declare(node: Node, cls: type[BaseModel], prefix: str) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for name, field in cls.model_fields.items():
        default = field.get_default(call_default_factory=True)
        if isinstance(default, BaseModel):
            values[name] = _declare(node, type(default), f"{prefix}{name}.")
        elif section := _optional_section(field.annotation):
            values[name] = _declare_without_defaults(node, section, f"{prefix}{name}.") or None
        else:
            values[name] = _value(node, prefix + name, field.description, default)
    return values


def _declare_without_defaults(node: Node, cls: type[BaseModel], prefix: str) -> dict[str, Any]:
    """The parameters of an optional section that were given; the others have no value, not even a default."""
    values = {
        name: _value(node, prefix + name, field.description, None) for name, field in cls.model_fields.items()
    }
    return {name: value for name, value in values.items() if value is not None}


def _value(node: Node, name: str, description: str | None, default: Any) -> Any:
    # Any type is let in, such as 1 where 1.0 is the default; the configuration class judges the value.
    descriptor = ParameterDescriptor(description=description or "", dynamic_typing=True)
    plain = list(default) if isinstance(default, tuple) else default
    value = node.declare_parameter(name, plain, descriptor).value
    return list(value) if hasattr(value, "typecode") else value  # rclpy hands out arrays as array.array


def _optional_section(annotation: Any) -> type[BaseModel] | None:
    """The configuration class of a field that may also be None."""
    kinds = get_args(annotation) if isinstance(annotation, UnionType) else ()
    classes = [kind for kind in kinds if isinstance(kind, type) and issubclass(kind, BaseModel)]
    return classes[0] if classes else None
