"""ROS parameters from a configuration class: declared with what its fields say, and validated by it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Generic, TypeVar

from pydantic import BaseModel
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_core.parameter_fields import (
    ParameterField,
    default_values,
    flat_values,
    is_of_kind,
    kind_in_words,
    nested,
    parameter_fields,
)

C = TypeVar("C", bound=BaseModel)

PLACES = "from its parameter file, a preset or --set"
"""Where the values come from with which a node is started."""
INTEGERS = (-(2**63), 2**63 - 1)
"""Least and greatest integer of a ROS parameter."""
TYPES = {
    (bool, False): Parameter.Type.BOOL,
    (int, False): Parameter.Type.INTEGER,
    (float, False): Parameter.Type.DOUBLE,
    (str, False): Parameter.Type.STRING,
    (bool, True): Parameter.Type.BOOL_ARRAY,
    (int, True): Parameter.Type.INTEGER_ARRAY,
    (float, True): Parameter.Type.DOUBLE_ARRAY,
    (str, True): Parameter.Type.STRING_ARRAY,
}
"""Type of a parameter by the kind of its elements, and whether it is a list of them."""


class ParameterSet(Generic[C]):
    """The parameters of a node as one validated configuration.

    Args:
        node: gets the parameters declared, with the values that it was started with.
        cls: says everything about them.
        on_change: takes the configuration with a new value; a PackError that it raises refuses the value.

    Attributes:
        config: the configuration in force.

    Raises:
        ConfigError: a value that was given is not allowed.
    """

    def __init__(self, node: Node, cls: type[C], on_change: Callable[[C], None] | None) -> None:
        self._class, self._on_change = cls, on_change
        self._source = f"parameters of node '{node.get_name()}' ({PLACES})"
        self.fields = {field.name: field for field in parameter_fields(cls)}
        assert on_change or not any(field.changeable for field in self.fields.values()), cls
        given = {name: plain(item.value) for name, item in node._parameter_overrides.items()}
        self._values = default_values(cls)
        self.config = self._validated({name: given[name] for name in self.fields if name in given})
        self._source = f"parameters of node '{node.get_name()}'"  # whoever sets one now knows where
        for name, value in flat_values(self.config, cls).items():
            _declare(node, self.fields[name], value)

    def change(self, parameters: Sequence[Parameter]) -> tuple[list[Parameter], str]:
        """Put new values in force, all of them or none.

        Returns:
            The parameters as they are to be stored, and from when on they count, in words.

        Raises:
            PackError: a value is not allowed or may not be changed; the error's text is the reason.
        """
        for parameter in parameters:
            self._require_changeable(parameter)
        given = {parameter.name: plain(parameter.value) for parameter in parameters}
        config = self._validated(given)
        assert self._on_change is not None
        self._on_change(config)
        self.config = config
        self._values |= given
        now = flat_values(config, self._class)
        stored = [_parameter(self.fields[name], now[name]) for name in given]
        return stored, "; ".join(sorted({self.fields[name].changeable.when for name in given}))

    def _require_changeable(self, parameter: Parameter) -> None:
        field = self.fields.get(parameter.name)
        if field is None or field.changeable is None:
            raise ConfigError(
                f"'{parameter.name}' is read when the node starts: set it in the parameter file, or by "
                "--set (pack up) or -p (ros2 run), and start the node again"
            )
        if parameter.type_ == Parameter.Type.NOT_SET:
            raise ConfigError(f"'{parameter.name}' cannot be deleted, only set to another value")

    def _validated(self, given: Mapping[str, Any]) -> C:
        """The configuration with these values over those in force."""
        for name, value in given.items():
            if not is_of_kind(self.fields[name], value):
                allowed = kind_in_words(self.fields[name])
                raise ConfigError(f"{self._source}: key '{name}' is {value!r}; allowed: {allowed}")
        return validate_config(self._class, nested(self._values | dict(given)), self._source)


def plain(value: Any) -> Any:
    """A parameter's value in Python's own types; rclpy hands out lists as array.array."""
    return list(value) if hasattr(value, "typecode") or isinstance(value, tuple) else value


def unknown_parameters(node: Node) -> list[str]:
    """Parameters that were given to the node and that it does not have, each in words.

    To be called once all parameters are declared.
    """
    given: dict[str, Any] = node._parameter_overrides  # rclpy has no public name for it
    return [unknown(node, name) for name in given if not node.has_parameter(name)]


def unknown(node: Node, name: str) -> str:
    """A name that is no parameter of the node, with the nearest that are."""
    near = get_close_matches(name, node.get_parameters_by_prefix(""), n=3)
    meant = " or ".join(f"'{other}'" for other in near)
    return f"'{name}'" + (f"; did you mean {meant}?" if near else "")


def read_only(description: str) -> ParameterDescriptor:
    """The descriptor of a parameter that is read at start only."""
    return ParameterDescriptor(description=description, read_only=True)


def _declare(node: Node, field: ParameterField, value: Any) -> None:
    descriptor = ParameterDescriptor(
        description=field.description,
        additional_constraints=field.constraint,
        read_only=field.changeable is None,
        # What has no value has no type yet, and an empty list says not of what.
        dynamic_typing=value is None or value == [],
    )
    if field.changeable is not None:
        descriptor.description += f"; a new value counts {field.changeable.when}"
    _limit(descriptor, field)
    node.declare_parameter(field.name, _parameter(field, value).value, descriptor, ignore_override=True)


def _limit(descriptor: ParameterDescriptor, field: ParameterField) -> None:
    if field.lowest is None and field.highest is None:
        return
    least, most = INTEGERS if field.kind is int else (-float("inf"), float("inf"))
    ends = {
        "from_value": field.kind(least if field.lowest is None else field.lowest),
        "to_value": field.kind(most if field.highest is None else field.highest),
    }
    if field.kind is int:
        descriptor.integer_range = [IntegerRange(**ends)]
    else:
        descriptor.floating_point_range = [FloatingPointRange(**ends)]


def _parameter(field: ParameterField, value: Any) -> Parameter:
    if value is None:
        return Parameter(field.name)
    return Parameter(field.name, TYPES[field.kind, field.is_list], value)
