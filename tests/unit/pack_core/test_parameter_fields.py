"""A configuration class as a list of parameters."""

from __future__ import annotations

from enum import Enum
from typing import Annotated, ClassVar, Literal

import pytest
from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.config import AT_ONCE, NEXT_GOAL, Changeable, Config
from pack_core.parameter_fields import (
    ParameterField,
    default_values,
    flat_values,
    is_of_kind,
    nested,
    parameter_fields,
)


class Mode(Enum):
    FAST = "fast"
    SLOW = "slow"


class Limits(Config):
    force: PositiveFloat = Field(default=3.0, description="largest force [N]")
    tries: PositiveInt = Field(default=2, lt=9, description="number of tries")


class Task(Config):
    changeable: ClassVar[Changeable] = NEXT_GOAL

    timeout: float = Field(default=20.0, ge=0, le=60, description="of a goal [s]")
    gains: tuple[PositiveFloat, ...] = Field(default=(1.0, 2.0), description="of the joints")


class Whole(Task):
    limits: Annotated[Limits, AT_ONCE] = Limits(force=5.0)
    spare: Limits | None = None
    mode: Mode = Field(default=Mode.SLOW, description="how fast")
    price: Literal["low", "high"] = Field(default="low", description="of a move")
    seed: int | None = Field(default=None, description="of the noise")


FIELDS = {field.name: field for field in parameter_fields(Whole)}


def test_sections_become_dotted_names_also_those_that_may_be_none() -> None:
    assert list(FIELDS) == [
        "timeout", "gains", "limits.force", "limits.tries", "spare.force", "spare.tries", "mode", "price",
        "seed",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "mark"),
    [("timeout", NEXT_GOAL), ("limits.tries", AT_ONCE), ("spare.tries", None), ("mode", None)],
)
def test_a_mark_counts_for_a_field_a_section_or_the_fields_of_one_class(
    name: str, mark: Changeable | None
) -> None:
    assert FIELDS[name].changeable is mark


@pytest.mark.parametrize(
    ("name", "kind", "is_list"),
    [
        ("timeout", float, False),
        ("gains", float, True),
        ("limits.tries", int, False),
        ("mode", str, False),
        ("price", str, False),
        ("seed", int, False),
    ],
)
def test_the_type_is_that_of_the_field(name: str, kind: type, is_list: bool) -> None:
    assert (FIELDS[name].kind, FIELDS[name].is_list) == (kind, is_list)


@pytest.mark.parametrize(
    ("name", "lowest", "highest", "constraint"),
    [
        ("timeout", 0, 60, ""),
        ("limits.force", 0, None, "greater than 0"),
        ("limits.tries", 1, 8, ""),
        ("mode", None, None, "one of: fast, slow"),
        ("price", None, None, "one of: low, high"),
        ("gains", None, None, ""),
    ],
)
def test_limits_are_those_of_the_field(
    name: str, lowest: float | None, highest: float | None, constraint: str
) -> None:
    field = FIELDS[name]
    assert (field.lowest, field.highest, field.constraint) == (lowest, highest, constraint)


def test_default_values_make_the_default_configuration() -> None:
    values = default_values(Whole)
    assert values["limits.force"] == 5.0
    assert "spare.force" not in values
    assert Whole.model_validate(nested(values)) == Whole()


def test_the_values_of_a_configuration_make_it_again() -> None:
    config = Whole(spare=Limits(tries=4), mode=Mode.FAST, seed=3)
    values = flat_values(config, Whole)
    assert values["mode"] == "fast"
    assert values["gains"] == [1.0, 2.0]
    assert Whole.model_validate(nested(values)) == config
    assert flat_values(Whole(), Whole)["spare.tries"] is None


def test_a_type_that_no_parameter_can_have_is_named() -> None:
    class Odd(Config):
        table: dict[str, int] = Field(default_factory=dict, description="of what")

    with pytest.raises(TypeError, match=r"dict\[str, int\]"):
        list(parameter_fields(Odd))


@pytest.mark.parametrize(
    ("kind", "is_list", "value", "fits"),
    [
        (float, False, 1, True),
        (float, False, True, False),
        (int, False, 1.0, False),
        (int, False, True, False),
        (bool, False, 1, False),
        (bool, False, True, True),
        (str, False, 1, False),
        (float, True, [1, 2.5], True),
        (float, True, 1.0, False),
        (str, True, "ab", False),
        (str, True, [], True),
    ],
)
def test_a_whole_number_is_a_number_and_nothing_else_is_something_else(
    kind: type, is_list: bool, value: object, fits: bool
) -> None:
    field = ParameterField("name", kind, is_list, "", None, None, "", None)
    assert is_of_kind(field, value) is fits
