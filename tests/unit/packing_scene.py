"""A scene for the controller: the configured objects, hand-placed."""

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, from_yaw
from pack_core.states import ObjectState, SceneState
from pack_mpc.plant import PackingPlant

SPOTS = {
    "soup_can": (0.42, 0.06), "coffee_tin": (0.58, 0.06), "tea_box": (0.50, 0.06),
    "cracker_box": (0.43, -0.06), "sugar_box": (0.57, -0.06),
}  # fmt: skip


@pytest.fixture(scope="session")
def scene() -> Scene:
    scene = packing_cell().scene
    poses = {
        item.name: Pose(np.array([*SPOTS[item.name], item.half_extents[2]]), from_yaw(np.pi / 2))
        for item in scene.objects
    }
    return scene.with_poses(poses)


@pytest.fixture(scope="session")
def plant(scene: Scene) -> PackingPlant:
    return PackingPlant(scene.description(), packing_cell(), timestep=0.006, threads=2)


@pytest.fixture
def joints() -> JointSample:
    return JointSample(0.0, np.array(packing_cell().robot.home), np.zeros(7), np.zeros(7))


@pytest.fixture
def state(scene: Scene) -> SceneState:
    held = {scene.new_object.name: ObjectState(Pose(np.array([0.5, 0.0, 0.36])))}
    return SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in scene.poses().items()} | held)
