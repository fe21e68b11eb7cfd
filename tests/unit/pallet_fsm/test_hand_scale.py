"""The scale against torques that MuJoCo's inverse dynamics gives for a known load."""

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.palletizing.arm_dynamics import CarriedLoad
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.robots.kr210 import FRICTION, LIMITS
from pack_core.rotations import Array, Pose, from_yaw
from pallet_fsm.hand_scale import HandScale

CELL = palletizing_cell()
DIMS = (0.4, 0.3, 0.25)
X_TB = Pose(np.array([0.02, -0.01, 0.126]), from_yaw(0.3))
PERIOD = 0.004


def motion(
    seconds: float, start: float, load: CarriedLoad, friction: Array, noise: float = 0.0, seed: int = 0
) -> Iterator[JointSample]:
    """Samples of joints that swing, each at its own rate."""
    rng, data, home = np.random.default_rng(seed), mujoco.MjData(load.model), np.array(CELL.arm.home)
    w = np.array([0.7, 0.6, 0.75, 0.5, 0.8, 0.45])
    for time in start + np.arange(0.0, seconds, PERIOD):
        q, v, a = home + 0.2 * np.sin(w * time), 0.2 * w * np.cos(w * time), -0.2 * w**2 * np.sin(w * time)
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(load.model, data)
        tau = data.qfrc_inverse + friction * np.sign(v) + noise * LIMITS.effort * rng.standard_normal(6)
        yield JointSample(time, q, v, tau)


def weighed(mass: float, friction: Array, noise: float = 0.0, seed: int = 0) -> float:
    """What the scale says of a box that it lifts for 0.4 s, after 4 s with an empty hand."""
    scale, load = HandScale(CELL), CarriedLoad(CELL)
    for sample in motion(4.0, 0.0, load, friction, noise, seed):
        scale.note(sample)
    load.put_on(BoxBody("box", DIMS, mass), X_TB)
    scale.put_on(np.array(DIMS), X_TB)
    assert scale.mass is None
    for sample in motion(0.4, 4.0, load, friction, noise, seed + 1):
        scale.note(sample)
        scale.note(sample)  # the machine steps more often than joints are told
    assert scale.mass is not None
    assert 0.3 < scale.seconds < 0.4
    return scale.mass


@pytest.mark.parametrize("mass", [0.8, 6.0, 30.0])
def test_it_weighs_what_is_there(mass: float) -> None:
    assert weighed(mass, FRICTION * LIMITS.effort) == pytest.approx(mass, abs=0.02)


def test_friction_that_nobody_knows_is_measured_with_an_empty_hand() -> None:
    friction = FRICTION * LIMITS.effort * np.array([0.7, 1.3, 0.8, 1.2, 1.4, 0.6])
    assert weighed(6.0, friction) == pytest.approx(6.0, abs=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_noise_of_the_torques_averages_out(seed: int) -> None:
    assert weighed(6.0, FRICTION * LIMITS.effort, noise=0.002, seed=seed) == pytest.approx(6.0, abs=0.8)


def test_an_arm_that_stands_says_nothing_as_friction_may_carry_the_load() -> None:
    scale, load = HandScale(CELL), CarriedLoad(CELL)
    scale.put_on(np.array(DIMS), X_TB)
    sample = next(motion(1.0, 0.0, load, np.zeros(6)))
    for i in range(50):
        scale.note(JointSample(0.02 * i, sample.q, np.zeros(6), sample.tau))
    assert scale.mass is None
    assert scale.seconds == 0.0


def test_an_empty_hand_weighs_nothing() -> None:
    scale = HandScale(CELL)
    scale.put_on(np.array(DIMS), X_TB)
    for sample in motion(0.4, 0.0, CarriedLoad(CELL), FRICTION * LIMITS.effort):
        scale.note(sample)
    assert scale.mass == pytest.approx(0.0, abs=0.02)


def test_samples_that_come_seldom_weigh_nothing() -> None:
    scale, load = HandScale(CELL), CarriedLoad(CELL)
    scale.put_on(np.array(DIMS), X_TB)
    for sample in list(motion(2.0, 0.0, load, FRICTION * LIMITS.effort))[::10]:
        scale.note(sample)
    assert scale.mass is None


@pytest.mark.parametrize("turn", [2, 4])
def test_an_arm_that_goes_by_jerks_weighs_nothing(turn: int) -> None:
    """A person who comes nearer slows the arm down by turns, which cancel out over some samples."""
    scale, load = HandScale(CELL), CarriedLoad(CELL)
    load.put_on(BoxBody("box", DIMS, 6.0), X_TB)
    scale.put_on(np.array(DIMS), X_TB)
    data, home, v_mean, jerk = mujoco.MjData(load.model), np.array(CELL.arm.home), 0.1, 0.4
    for i in range(100):
        phase = i % (2 * turn)
        a = jerk if phase < turn else -jerk
        v = np.full(6, v_mean + jerk * PERIOD * min(phase, 2 * turn - phase))
        data.qpos[:], data.qvel[:], data.qacc[:] = home + i * PERIOD * v_mean, v, a
        mujoco.mj_inverse(load.model, data)
        tau = data.qfrc_inverse + FRICTION * LIMITS.effort
        scale.note(JointSample(i * PERIOD, np.array(data.qpos), v, tau))
    assert scale.mass is None
