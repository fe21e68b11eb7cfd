"""The cameras of the preset `hardware` see everything before the arm moves, and lose objects in INSERT."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pack_core.bodies import set_object_poses
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_core.robots.panda import PANDA
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_perception.mocap.rigid_body_fit import FitConfig
from pack_sim.packing.mocap import MocapSystem
from pack_sim.packing.scene_generator import generate_scene

HARDWARE, IDEAL = load_preset("hardware"), load_preset("ideal")
CELL = HARDWARE.packing_cell()
INSERTED = 0.06
"""Height of the held object's bottom over the base in the middle of INSERT [m]."""


@pytest.fixture(scope="module")
def scenes() -> list[Scene]:
    return [generate_scene(seed, CELL) for seed in range(4)]


def posed(scene: Scene, height: float | None = None) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The arm at home, or with the held object's bottom at a height in the middle of the container."""
    model = build_model(scene, CELL, timestep=0.001, arm=ArmRole.DRIVEN, held=HeldRole.RIGID)
    data = mujoco.MjData(model)
    set_object_poses(model, data, scene.poses())
    q = np.array([model.joint(name).qposadr[0] for name in PANDA.joints])
    v = np.array([model.joint(name).dofadr[0] for name in PANDA.joints])
    data.qpos[q] = CELL.robot.home
    mujoco.mj_forward(model, data)
    held = model.body(scene.new_object.name).id
    jacobian, turn = np.zeros((2, 3, model.nv))
    for _ in range(40 if height is not None else 0):
        goal = np.array([*scene.container.centre, height + scene.new_object.half_extents[2]])
        mujoco.mj_jacBody(model, data, jacobian, turn, held)
        J = np.concatenate([jacobian[:, v], turn[:, v]])
        tilt = np.cross(data.xmat[held].reshape(3, 3)[:, 2], [0.0, 0.0, 1.0])
        data.qpos[q] += np.linalg.pinv(J) @ [*(goal - data.xpos[held]), *tilt]
        mujoco.mj_forward(model, data)
    return model, data


def hidden(preset, scene: Scene, height: float | None = None) -> set[str]:
    """Objects of which fewer markers are seen than a pose needs."""
    config = lockstep_config(preset)
    mocap = MocapSystem(scene, preset.packing_cell(), config.simulator.mocap, np.random.default_rng(0))
    frame = mocap.capture(*posed(scene, height), 0.0)
    counts = np.bincount(frame.object_index, minlength=len(frame.objects))
    fit: FitConfig = config.estimator.fit
    return {name for name, n in zip(frame.objects, counts, strict=True) if n < fit.min_markers}


def test_everything_is_seen_before_the_arm_moves(scenes: list[Scene]) -> None:
    assert [hidden(HARDWARE, scene) for scene in scenes] == [set()] * len(scenes)


def test_objects_are_lost_when_the_held_object_is_among_them(scenes: list[Scene]) -> None:
    lost = [len(hidden(HARDWARE, scene, INSERTED) & set(scene.names)) for scene in scenes]
    assert np.mean(lost) >= 0.5
    seen = [len(hidden(IDEAL, scene, INSERTED) & set(scene.names)) for scene in scenes]
    assert np.mean(seen) < 0.5
