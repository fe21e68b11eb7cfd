"""Scenes to plan in."""

from collections.abc import Callable

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState

HELD = Pose(np.array([0.5, 0.0, 0.5]))


@pytest.fixture
def example() -> Scene:
    """The blocked example scene."""
    return load_scene(config_path("scenarios", "packing", "example.yaml"))


@pytest.fixture
def empty() -> Scene:
    """The cell's container with nothing in it."""
    return packing_cell().scene.model_copy(update={"objects": []})


@pytest.fixture
def state_of() -> Callable[[Scene], SceneState]:
    """The objects of a scene where it has them, the new one in the air."""

    def state_of(scene: Scene) -> SceneState:
        poses = scene.poses() | {scene.new_object.name: HELD}
        return SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in poses.items()})

    return state_of
