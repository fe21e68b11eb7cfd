"""A configuration class as a flat list of parameters: what each is for, and what it may be.

Everything comes from the fields of the class, so that a parameter is described in one place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pack_core.config import Changeable


@dataclass(frozen=True)
class ParameterField:
    """One parameter of a configuration class.

    Attributes:
        name: dotted, with the names of the sections that it is in.
        kind: bool, int, float or str; of a list, that of its elements.
        is_list: whether it is a list of `kind`.
        description: what it is for, with its unit.
        lowest: least value that is not refused; None where there is no limit, or for a list.
        highest: greatest value that is not refused, likewise.
        constraint: what `lowest` and `highest` do not say, in words; empty if nothing.
        changeable: from when on a new value counts; None: it is read at start only.
    """

    name: str
    kind: type
    is_list: bool
    description: str
    lowest: float | None
    highest: float | None
    constraint: str
    changeable: Changeable | None


def parameter_fields(
    cls: type[BaseModel], prefix: str = "", changeable: Changeable | None = None
) -> Iterator[ParameterField]:
    """The parameters of a configuration class; those of its sections have dotted names.

    Args:
        cls: the class.
        prefix: of the names.
        changeable: of the section that the class stands for; its fields inherit it.
    """
    for name, field in cls.model_fields.items():
        own = _mark(cls, name, field) or changeable
        if section := section_of(field):
            yield from parameter_fields(section, f"{prefix}{name}.", own)
        else:
            yield _parameter(prefix + name, field, own)


def section_of(field: FieldInfo) -> type[BaseModel] | None:
    """The configuration class of a field that is a section of parameters, also of one that may be None."""
    kinds = get_args(field.annotation) if _is_union(field.annotation) else (field.annotation,)
    classes = [kind for kind in kinds if isinstance(kind, type) and issubclass(kind, BaseModel)]
    return classes[0] if classes else None


def flat_values(config: BaseModel | None, cls: type[BaseModel], prefix: str = "") -> dict[str, Any]:
    """The values of a configuration by dotted name; None for all those of a section that is None."""
    values: dict[str, Any] = {}
    for name, field in cls.model_fields.items():
        value = None if config is None else getattr(config, name)
        if section := section_of(field):
            values |= flat_values(value, section, f"{prefix}{name}.")
        else:
            values[prefix + name] = _plain(value)
    return values


def default_values(cls: type[BaseModel], prefix: str = "") -> dict[str, Any]:
    """The default values by dotted name; without those of sections that are None by default."""
    values: dict[str, Any] = {}
    for name, field in cls.model_fields.items():
        default = field.get_default(call_default_factory=True)
        if isinstance(default, BaseModel):
            values |= flat_values(default, type(default), f"{prefix}{name}.")
        elif section_of(field) is None:
            values[prefix + name] = _plain(default)
    return values


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values by dotted name as the keys and sections that a configuration class is made from."""
    tree: dict[str, Any] = {}
    for name, value in values.items():
        *sections, last = name.split(".")
        place = tree
        for section in sections:
            place = place.setdefault(section, {})
        place[last] = value
    return tree


def is_of_kind(field: ParameterField, value: Any) -> bool:
    """Whether a value has the type of a parameter; a whole number may stand for any number."""
    kinds, items = (int, float) if field.kind is float else (field.kind,), value if field.is_list else [value]
    if not isinstance(items, Sequence) or isinstance(items, str):
        return False
    # True and False count as integers in Python.
    return all(isinstance(item, kinds) and (field.kind is bool) == isinstance(item, bool) for item in items)


def kind_in_words(field: ParameterField) -> str:
    """What type of value a parameter has."""
    one = {bool: "true or false", int: "a whole number", float: "a number", str: "a text"}[field.kind]
    return f"a list, each {one}" if field.is_list else one


def _mark(cls: type[BaseModel], name: str, field: FieldInfo) -> Changeable | None:
    """The mark of a field, or that of the class that declares it."""
    for item in field.metadata:
        if isinstance(item, Changeable):
            return item
    declaring = next((kind for kind in cls.__mro__ if name in vars(kind).get("__annotations__", {})), cls)
    return vars(declaring).get("changeable")


def _parameter(name: str, field: FieldInfo, changeable: Changeable | None) -> ParameterField:
    kind, is_list = _kind_of(field.annotation)
    lowest, highest = (None, None) if is_list else (_lowest(field, kind), _highest(field, kind))
    words = []
    if kind is float and not is_list:
        # A range of ROS includes both of its ends, so that an end that is excluded is said in words.
        words += [f"greater than {bound.gt:g}" for bound in _bounds(field, Gt)]
        words += [f"less than {bound.lt:g}" for bound in _bounds(field, Lt)]
    if choices := _choices(field.annotation):
        words.append("one of: " + ", ".join(choices))
    return ParameterField(
        name, kind, is_list, field.description or "", lowest, highest, "; ".join(words), changeable
    )


def _lowest(field: FieldInfo, kind: type) -> float | None:
    bounds = [bound.ge for bound in _bounds(field, Ge)]
    bounds += [bound.gt + 1 if kind is int else bound.gt for bound in _bounds(field, Gt)]
    return max(bounds, default=None)


def _highest(field: FieldInfo, kind: type) -> float | None:
    bounds = [bound.le for bound in _bounds(field, Le)]
    bounds += [bound.lt - 1 if kind is int else bound.lt for bound in _bounds(field, Lt)]
    return min(bounds, default=None)


def _bounds(field: FieldInfo, kind: type) -> list[Any]:
    return [item for item in field.metadata if isinstance(item, kind)]


def _kind_of(annotation: Any) -> tuple[type, bool]:
    """The type of a parameter's elements, and whether it is a list of them."""
    for member in _members(annotation):
        if get_origin(member) is tuple:
            return _kind_of(get_args(member)[0])[0], True
        if get_origin(member) is Literal:
            return type(get_args(member)[0]), False
        if isinstance(member, type) and issubclass(member, Enum):
            return type(next(iter(member)).value), False
        if hasattr(member, "__metadata__"):  # Annotated[...]
            return _kind_of(get_args(member)[0])
        if member in (bool, int, float, str):
            return member, False
    raise TypeError(f"no ROS parameter can hold {annotation}; allowed: bool, int, float, str, tuples of them")


def _choices(annotation: Any) -> list[str]:
    for member in _members(annotation):
        if get_origin(member) is Literal:
            return [str(choice) for choice in get_args(member)]
        if isinstance(member, type) and issubclass(member, Enum):
            return [str(choice.value) for choice in member]
    return []


def _plain(value: Any) -> Any:
    """A value as a ROS parameter holds it."""
    if isinstance(value, tuple):
        return list(value)
    return value.value if isinstance(value, Enum) else value


def _members(annotation: Any) -> tuple[Any, ...]:
    members = get_args(annotation) if _is_union(annotation) else (annotation,)
    return tuple(member for member in members if member is not type(None))


def _is_union(annotation: Any) -> bool:
    return isinstance(annotation, UnionType) or get_origin(annotation) is Union
