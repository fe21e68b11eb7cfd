"""Lists of objects that fill a container."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from pack_core.errors import ConfigError
from pack_core.packing.cell import packing_cell
from pack_core.packing.packing_list import draw_list, load_list, parse_list
from pack_core.packing.scene_file import parse_scene
from pack_core.paths import config_path

CELL = packing_cell()
CATALOGUE = load_list(config_path("packing_lists", "supermarket.yaml"), CELL)


def test_a_drawn_list_is_decided_by_its_seed_and_names_every_object_once() -> None:
    first, again, other = (draw_list(seed, 8, CATALOGUE) for seed in (500, 500, 501))
    names = [item.name for item in first.objects]
    assert first == again
    assert names != [item.name for item in other.objects]
    assert len(set(names)) == 8
    sizes = {tuple(item.half_extents) for item in CATALOGUE.objects}
    assert {tuple(item.half_extents) for item in first.objects} <= sizes


@pytest.mark.parametrize(
    "path", sorted(config_path("packing_lists", "").glob("*.yaml")), ids=lambda p: p.stem
)
def test_the_lists_of_the_project_begin_in_a_scene_that_the_cell_accepts(path: Path) -> None:
    given = load_list(path, CELL)
    start = parse_scene(given.start(CELL).to_yaml(), "start", CELL)
    assert start.objects == []
    assert start.is_handed_over
    assert start.new_object.name == given.objects[0].name


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"pose": {"position": [0, 0, 0]}}, "handed over"),
        ({"mass": 5.0}, "payload"),
        ({"size": [0.03, 0.1, 0.1]}, "width of the cup"),
        ({"size": [0.1, 0.1]}, "size"),
        ({"colour": "red"}, "colour"),
        ({"name": "wall_left"}, "names that the cell itself uses: wall_left"),
    ],
)
def test_a_list_that_cannot_be_packed_is_refused_with_the_reason(
    change: dict[str, object], reason: str
) -> None:
    item = {"name": "tea", "shape": "box", "size": [0.09, 0.06, 0.13], "mass": 0.3, **change}
    with pytest.raises(ConfigError, match=reason):
        parse_list(yaml.safe_dump({"objects": [item]}), "given", CELL)


def test_objects_of_the_same_name_are_refused() -> None:
    item = {"name": "tea", "shape": "box", "size": [0.09, 0.06, 0.13], "mass": 0.3}
    with pytest.raises(ConfigError, match="every object its own"):
        parse_list(yaml.safe_dump({"objects": [item, item]}), "given", CELL)
