"""A scene survives its file, and describes itself without poses."""

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose, exp


@pytest.fixture
def scene() -> Scene:
    return load_scene(config_path("scenarios", "packing", "example.yaml"))


def test_a_scene_survives_its_text_bit_for_bit(scene: Scene) -> None:
    tilted = Pose(np.array([0.5, 0.01, 0.0551]), exp([0.1, 0.2, 0.3]))
    moved = scene.with_poses(scene.poses() | {"soup_can": tilted})
    again = Scene.from_yaml(moved.to_yaml())
    assert again == moved
    assert np.array_equal(again.poses()["soup_can"].p, tilted.p)


def test_moving_objects_leaves_the_scene_itself_alone(scene: Scene) -> None:
    before = scene.to_yaml()
    scene.with_poses({name: Pose(np.array([0.5, 0.0, 0.1])) for name in scene.names})
    assert scene.to_yaml() == before


def test_a_description_has_no_poses(scene: Scene) -> None:
    assert "pose" not in scene.description().to_yaml()
    with pytest.raises(ConfigError, match="soup_can"):
        scene.description().poses()


def test_objects_are_found_by_name_the_new_one_too(scene: Scene) -> None:
    assert scene.model_of("passata") is scene.new_object
    with pytest.raises(ConfigError, match=r"'spoon'.*soup_can"):
        scene.model_of("spoon")


def test_the_example_has_the_objects_of_the_cell(scene: Scene) -> None:
    assert scene.description() == packing_cell().scene
