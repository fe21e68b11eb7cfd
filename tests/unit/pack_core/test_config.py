"""Configuration files say what is wrong with them."""

from pathlib import Path

import pytest
from pydantic import PositiveFloat, ValidationError

from pack_core.config import Config, load_config, merged, parse_config
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.paths import config_path


class Oven(Config):
    """Something to configure."""

    heat: PositiveFloat
    racks: int = 2


def refusal(text: str) -> str:
    with pytest.raises(ConfigError) as caught:
        parse_config(Oven, text, "oven.yaml")
    return str(caught.value)


def test_files_override_defaults() -> None:
    assert parse_config(Oven, "heat: 180", "oven.yaml") == Oven(heat=180.0, racks=2)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("heat: 180\nrakcs: 3", ["rakcs", "not known"]),
        ("racks: 3", ["heat", "missing"]),
        ("heat: -5", ["'heat' is -5; allowed: greater than 0"]),
        ("heat: {low: 3}", ["'heat' is {'low': 3}; allowed: a valid number"]),
        ("heat: warm", ["heat", "warm", "number"]),
        ("heat: [", ["not readable as YAML"]),
        ("- heat", ["keys and values", "list"]),
        ("heat: -5\nracks: many", ["heat", "racks"]),
    ],
)
def test_errors_name_file_key_value_and_what_is_allowed(text: str, parts: list[str]) -> None:
    message = refusal(text)
    for part in ["oven.yaml", *parts]:
        assert part in message


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"nowhere\.yaml: no such file"):
        load_config(Oven, tmp_path / "nowhere.yaml")


def test_configurations_are_frozen() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Oven(heat=180.0).heat = 200.0  # type: ignore[misc]


def test_the_packing_cell_is_read_from_config() -> None:
    cell = load_config(PackingCell, config_path("cells", "packing.yaml"))
    assert cell == packing_cell()
    assert len(cell.scene.objects) == 5


def test_what_lies_over_replaces_values_and_merges_sections() -> None:
    below = {"a": 1, "section": {"b": [1, 2], "c": 3}, "list": [1]}
    assert merged(below, {"section": {"b": [4]}, "list": [], "new": {"d": 5}}) == {
        "a": 1, "section": {"b": [4], "c": 3}, "list": [], "new": {"d": 5},
    }  # fmt: skip
    assert below["section"] == {"b": [1, 2], "c": 3}


def test_what_lies_over_the_packing_cell_changes_what_it_names() -> None:
    changed = packing_cell("suction: {shear: 12.0}")
    assert changed.suction.shear == 12.0
    suction = changed.suction.model_copy(update={"shear": packing_cell().suction.shear})
    assert changed.model_copy(update={"suction": suction}) == packing_cell()


@pytest.mark.parametrize(
    ("over", "part"),
    [
        ("suctoin: {}", "'suctoin' is not known"),
        ("suction: {pull: -1}", "'suction.pull' is -1"),
        ("- a", "keys"),
    ],
)
def test_what_may_not_lie_over_the_packing_cell_is_refused(over: str, part: str) -> None:
    with pytest.raises(ConfigError, match=part):
        packing_cell(over)
