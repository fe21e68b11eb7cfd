"""Twist splines and the joint references they become."""

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.model import HELD_POSITION, ArmRole
from pack_core.packing.scene import Scene
from pack_mpc.optimizers.sgn import SgnConfig
from pack_mpc.optimizers.spline import BENDING_RATE, Basis, ResolvedRateServo
from pack_mpc.plant import PackingPlant

TIMES = 0.012 * np.arange(50)
BASIS = Basis(TIMES, np.linspace(0.0, 0.6, 3))


@pytest.fixture(scope="module")
def plant(scene: Scene) -> PackingPlant:
    return PackingPlant(scene.description(), packing_cell(), timestep=0.012, threads=1, arm=ArmRole.SERVO)


def test_the_spline_goes_through_its_knots() -> None:
    theta = np.random.default_rng(0).normal(size=(3, 6))
    np.testing.assert_allclose(BASIS.matrix()[[0, 25]] @ theta, theta[:2])


def test_a_shifted_spline_is_the_same_motion_later() -> None:
    theta = np.random.default_rng(1).normal(size=(3, 6))
    later = BASIS.shifted(theta, 0.3)
    np.testing.assert_allclose(later[0], theta[1])
    np.testing.assert_allclose(later[1:], np.tile(theta[2], (2, 1)))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_constant_twist_moves_the_held_object_as_it_says(plant, joints, state, axis: int) -> None:
    x0 = plant.state(joints, state)
    twist = 0.1 * np.eye(6)[axis]
    servo = ResolvedRateServo(plant, joints.q, joints.q, leash=0.04)
    q, v = servo.references(np.tile(twist, (1, 50, 1)), 0.012)
    _, ys = plant.rollout(x0, np.concatenate([q, v], axis=2))
    moved = ys[0, -1, plant.sensor(HELD_POSITION)] - ys[0, 0, plant.sensor(HELD_POSITION)]
    np.testing.assert_allclose(moved, 0.6 * twist[:3], atol=6e-3)


def test_the_lead_of_a_reference_far_ahead_is_limited(plant, joints, state) -> None:
    x0 = plant.state(joints, state)
    servo = ResolvedRateServo(plant, joints.q, joints.q + 0.5, leash=0.04)
    q, _ = servo.references(np.zeros((1, 1, 6)), 0.012)
    ahead = x0.copy()
    ahead[plant.layout.q] = q[0, 0]
    lead = plant.held_position(ahead) - plant.held_position(x0)
    assert np.linalg.norm(lead) == pytest.approx(0.04, abs=3e-3)


def test_a_twist_out_of_reach_leaves_the_elbow_bent(plant, joints) -> None:
    """Away from the base for four horizons, farther than the arm reaches, and back for one."""
    q, out = joints.q, np.tile([1.0, 0.0, 0.3, 0.0, 0.0, 0.0], (1, 50, 1))
    for _ in range(4):
        q = ResolvedRateServo(plant, q, q, leash=0.04).references(out, 0.012)[0][0, -1]
    assert q[3] == pytest.approx(plant.bent[1][3])
    back = ResolvedRateServo(plant, q, q, leash=0.04).references(-out, 0.012)[0][0, -1]
    assert back[3] < q[3] - 0.5


def test_a_stretched_elbow_is_bent_again_at_a_rate(plant, joints) -> None:
    q, bent = joints.q.copy(), plant.bent[1][3]
    q[3] = bent + 0.2
    servo = ResolvedRateServo(plant, q, q, leash=0.04)
    references, v = servo.references(np.tile([0.4, 0.0, 0.0, 0.0, 0.0, 0.0], (1, 50, 1)), 0.012)
    np.testing.assert_allclose(references[0, :, 3], np.maximum(q[3] - BENDING_RATE * TIMES, bent))
    # what it does to the held object is not much faster than what twists do where that may land
    assert BENDING_RATE * np.linalg.norm(plant.held_jacobian(q)[:3, 3]) < 2.0 * SgnConfig().speed_landing
    assert v[0, 1:, 3].max() <= 0.0
    assert v[0, :, 1].min() > 0.0
