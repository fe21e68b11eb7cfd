"""Which keys a section of a configuration has, for the words about one that it has not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel

MOST = 12
"""Keys that are listed; of more only those like the one that was given are named."""


def meant(cls: type[BaseModel], keys: Sequence[Any]) -> str:
    """What may have been meant by a key that is not known, as the end of a sentence.

    Args:
        cls: class of the whole.
        keys: keys and places in lists from the whole to that key, as in pydantic's `loc`.
    """
    known = keys_beside(cls, keys)
    near = get_close_matches(str(keys[-1]), known, n=3)
    if near:
        names = " or ".join(f"'{name}'" for name in near)
        return f"did you mean {names}?"
    if 0 < len(known) <= MOST:
        return f"allowed: {', '.join(known)}"
    return "remove it or correct its spelling"


def keys_beside(cls: type[BaseModel], keys: Sequence[Any]) -> list[str]:
    """The keys of the section that the last of `keys` is in; none where they cannot be told."""
    models = [cls]
    for key in keys[:-1]:
        if isinstance(key, int):
            continue
        # pydantic puts the name of the kind between the keys of a section that may be of several kinds
        kinds = [model for model in models if key in _kinds_of(model)]
        models = kinds or [
            inner
            for model in models
            if key in model.model_fields
            for inner in _models_in(model.model_fields[key].annotation)
        ]
    return [name for model in models for name in model.model_fields]


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """The classes of sections among the parts of a type."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        return
    for part in get_args(annotation):
        yield from _models_in(part)


def _kinds_of(model: type[BaseModel]) -> set[Any]:
    """Names of the kind that a class stands for, where sections may be of several."""
    fields = model.model_fields.values()
    return {
        name
        for field in fields
        if get_origin(field.annotation) is Literal
        for name in get_args(field.annotation)
    }
