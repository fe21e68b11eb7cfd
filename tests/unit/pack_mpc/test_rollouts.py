"""Rollouts whose resting objects sleep."""

import mujoco
import numpy as np
import pytest

from pack_core.packing.rollouts import SHARED_MIN, Batch, SleepingRollouts
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


@pytest.mark.parametrize("threads", [1, 3])
def test_rollouts_that_begin_alike_end_where_each_would_end_alone(
    plant: PackingPlant, joints, state, controls: np.ndarray, threads: int
) -> None:
    x0s = np.tile(plant.state(joints, state), (8, 1))
    us = np.repeat(controls[:1], 8, axis=0)
    for i, shared in enumerate([STEPS, STEPS, STEPS - 1, 40, SHARED_MIN, SHARED_MIN - 1, 0, 20]):
        us[i, shared:] = controls[1, shared:]
    x0s[7, 0] += 1.0  # the same controls, but another state
    rollouts, one = SleepingRollouts(plant.model, threads), SleepingRollouts(plant.model, 1)
    alone = [one.run(x0s[i : i + 1], us[i : i + 1]) for i in range(8)]
    xs, ys = rollouts.run(x0s, us)
    np.testing.assert_array_equal(xs, np.concatenate([x for x, _ in alone]))
    np.testing.assert_array_equal(ys, np.concatenate([y for _, y in alone]))


def test_branches_are_the_rollouts_that_share_enough_steps_with_the_first(controls: np.ndarray) -> None:
    us = np.repeat(controls[:1], 5, axis=0)
    us[1, 10:], us[2, SHARED_MIN - 1 :], us[3, 30:] = 1.0, 1.0, 1.0
    x0s = np.zeros((5, 3))
    x0s[4] = 1.0
    empty = np.empty((5, STEPS, 0))
    assert Batch(x0s, us, empty, empty).branches() == ([0, 1, 3], 10)
    assert Batch(x0s[[0, 2, 4]], us[[0, 2, 4]], empty, empty).branches() == ([], 0)


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
