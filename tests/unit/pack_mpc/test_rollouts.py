"""Rollouts whose resting objects sleep."""

import mujoco
import numpy as np
import pytest

from pack_core.packing.rollouts import SleepingRollouts
from pack_mpc.plant import PackingPlant

STEPS = 60


@pytest.fixture
def controls() -> np.ndarray:
    return np.random.default_rng(0).normal(0.0, 3.0, (4, STEPS, 7))


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_neither_threads_nor_what_ran_before_matter(
    plant: PackingPlant, joints, state, controls: np.ndarray, threads: int
) -> None:
    x0 = plant.state(joints, state)
    expected, _ = SleepingRollouts(plant.model, 1).run(np.tile(x0, (4, 1)), controls)
    rollouts = SleepingRollouts(plant.model, threads)
    rollouts.run(x0[None], controls[:1])
    again, _ = rollouts.run(np.tile(x0, (4, 1)), controls[::-1])
    np.testing.assert_array_equal(again[::-1], expected)


def test_objects_at_rest_end_where_they_would_end_awake(plant: PackingPlant, joints, state) -> None:
    x0 = plant.state(joints, state)
    asleep, _ = SleepingRollouts(plant.model, 1).run(x0[None], np.zeros((1, STEPS, 7)))
    data = mujoco.MjData(plant.model)
    mujoco.mj_setState(plant.model, data, x0, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    for _ in range(STEPS):
        mujoco.mj_step(plant.model, data)
    for p in plant.layout.object_p.values():
        np.testing.assert_allclose(asleep[0, -1, p], data.qpos[p - 1], atol=2e-4)


def test_the_callers_model_keeps_its_objects_awake(plant: PackingPlant) -> None:
    SleepingRollouts(plant.model, 1)
    assert not plant.model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP
