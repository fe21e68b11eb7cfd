"""The cell with its second arm: the KUKA LBR iiwa 14 packs as the Panda does."""

import mujoco
import numpy as np
import pytest

from pack_core.bodies import body_pose
from pack_core.packing.goals import PackingMethod
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.rotations import rotate
from pack_lockstep.packing.lockstep import Lockstep
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_sim.packing.scene_generator import generate_scene

SEED = 52
PRESET = load_preset("iiwa14")


def test_at_home_the_tool_points_down_over_the_middle_of_the_container() -> None:
    cell = PRESET.packing_cell()
    model = build_model(cell.scene, cell, timestep=0.002, arm=ArmRole.DRIVEN, held=HeldRole.RIGID)
    data = mujoco.MjData(model)
    for name, position in zip(cell.robot.arm.joints, cell.robot.home, strict=True):
        data.joint(name).qpos = position
    mujoco.mj_forward(model, data)
    X_WT = body_pose(data, "tool")
    np.testing.assert_allclose(X_WT.p, [*cell.scene.container.centre, 0.45], atol=1e-3)
    np.testing.assert_allclose(rotate(X_WT.q, np.array([0.0, 0.0, 1.0])), [0.0, 0.0, -1.0], atol=1e-3)


def test_it_packs_a_blocked_scene() -> None:
    cell = PRESET.packing_cell()
    lockstep = Lockstep(
        cell, generate_scene(SEED, cell), lockstep_config(PRESET), PackingMethod.PACK_IT_IN, SEED
    )
    outcome = lockstep.run()
    run = lockstep.recorded()
    assert outcome.success, outcome.message
    assert run.arm == "iiwa14"
    limits = cell.robot.arm.limits
    assert np.all((run.joints >= limits.lower) & (run.joints <= limits.upper))
    assert run.truth[run.held].p[-1, 2] == pytest.approx(cell.scene.new_object.half_extents[2], abs=0.015)
