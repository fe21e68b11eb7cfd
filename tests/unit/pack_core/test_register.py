"""Registers of what there is by name."""

from importlib.metadata import EntryPoint
from math import tau

import pytest
from pydantic import Field

from pack_core import register
from pack_core.config import Config, validate_config
from pack_core.errors import ConfigError
from pack_core.register import Register, with_sections


def numbers(monkeypatch: pytest.MonkeyPatch, **added: str) -> Register[float]:
    """Pi ships; what is added comes from entry points of other packages."""
    entries = [EntryPoint(name, value, "numbers") for name, value in added.items()]
    monkeypatch.setattr(register, "entry_points", lambda group: entries if group == "numbers" else [])
    return Register("number", "numbers", {"pi": "math:pi"})


def test_what_ships_stands_before_what_others_add(monkeypatch: pytest.MonkeyPatch) -> None:
    register = numbers(monkeypatch, tau="math:tau", e="math:e")
    assert list(register) == ["pi", "e", "tau"]
    assert register["tau"] == tau


def test_only_what_is_asked_for_is_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    register = numbers(monkeypatch, broken="no_such_module:number")
    assert "broken" in register
    assert len(register) == 2
    with pytest.raises(ModuleNotFoundError):
        register["broken"]


def test_an_unknown_name_is_refused_with_all_that_are_registered(monkeypatch: pytest.MonkeyPatch) -> None:
    register = numbers(monkeypatch, e="math:e")
    with pytest.raises(ConfigError, match=r"number 'phi'; allowed: pi, e; .*numbers"):
        register["phi"]
    with pytest.raises(ConfigError, match=r"number 'phi'; allowed: pi, e; .*numbers"):
        register.checked("phi")
    assert register.checked("e") == register.known("e") == "e"
    with pytest.raises(ValueError, match="pi, e"):
        register.known("phi")


def test_two_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ConfigError, match="'pi': math:pi and cmath:pi"):
        list(numbers(monkeypatch, pi="cmath:pi"))


class Circle(Config):
    radius: float = Field(default=1.0, gt=0.0)


@with_sections({"circle": Circle})
class Drawing(Config):
    """What is drawn."""

    pens: int = 1


def test_a_configuration_has_a_section_for_each_name() -> None:
    drawing = validate_config(Drawing, {"circle": {"radius": 2.0}}, "drawing.yaml")
    assert drawing.model_dump() == {"pens": 1, "circle": {"radius": 2.0}}
    assert Drawing.__doc__ == "What is drawn."
    with pytest.raises(ConfigError, match=r"'circle\.size' is not known"):
        validate_config(Drawing, {"circle": {"size": 2.0}}, "drawing.yaml")
