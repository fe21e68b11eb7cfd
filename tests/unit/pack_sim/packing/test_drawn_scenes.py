"""Scenes drawn from a set of objects: repeatable, blocked, sound; what the set cannot give is named."""

import numpy as np
import pytest

from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.packing.free_space import footprint, is_blocked
from pack_core.packing.object_set import DrawnObjects, can_be_packed, draw_new_object, draw_scene
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import parse_scene
from pack_core.rotations import Pose, rotate
from pack_lockstep.packing.lockstep_config import load_preset
from pack_sim.packing.scene_generator import generate_scene

SEEDS = range(3)


@pytest.fixture(scope="module")
def cell() -> PackingCell:
    return load_preset("household").packing_cell()


@pytest.fixture(scope="module")
def scenes(cell: PackingCell) -> list[Scene]:
    return [generate_scene(seed, cell) for seed in SEEDS]


def test_the_same_seed_gives_the_same_scene_and_others_have_other_objects(
    cell: PackingCell, scenes: list[Scene]
) -> None:
    assert generate_scene(SEEDS[2], cell).to_yaml() == scenes[2].to_yaml()
    assert len({frozenset(scene.names) for scene in scenes}) == len(scenes)


def test_they_are_blocked_and_sound_scene_files(scenes: list[Scene], cell: PackingCell) -> None:
    for scene in scenes:
        assert is_blocked(scene)
        assert can_be_packed(scene.new_object, cell)
        assert parse_scene(scene.to_yaml(), "drawn", cell) == scene


def test_all_objects_together_cover_as_much_as_the_cell_says(scenes: list[Scene], cell: PackingCell) -> None:
    assert cell.drawn is not None
    for scene in scenes:
        items = [*scene.objects, scene.new_object]
        area = sum(footprint(item, Pose(np.zeros(3))).area for item in items)
        least, most = cell.drawn.base_area
        assert least <= area / np.prod(scene.container.size) <= most


def test_a_capsule_that_has_rolled_has_its_markers_on_top(scenes: list[Scene]) -> None:
    lying = [(scene, item.name) for scene in scenes for item in scene.objects if item.shape == "capsule"]
    assert lying
    for scene, name in lying:
        assert rotate(scene.poses()[name].q, [0.0, 0.0, 1.0])[2] > np.cos(np.deg2rad(5.0))


def test_a_share_of_the_base_that_no_draw_covers_is_refused() -> None:
    tight = DrawnObjects(object_set="household", base_area=(0.001, 0.002))
    with pytest.raises(PackError, match=r"household\.yaml cover 0\.001 to 0\.002 of the base"):
        draw_scene(tight, packing_cell(), packing_cell().scene.new_object, np.random.default_rng(0))


def test_a_set_of_which_nothing_can_be_packed_is_refused(cell: PackingCell) -> None:
    container = cell.scene.container.model_copy(update={"height": 0.4})
    deep = cell.model_copy(update={"scene": cell.scene.model_copy(update={"container": container})})
    assert deep.drawn is not None
    with pytest.raises(PackError, match=r"no object of .*household\.yaml can be packed"):
        draw_new_object(deep.drawn, deep, np.random.default_rng(0))
