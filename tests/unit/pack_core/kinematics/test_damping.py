"""Damped least squares."""

import numpy as np
import pytest

from pack_core.kinematics.damping import DAMPING, damped_inverse, damped_square


def test_far_from_singular_postures_it_is_the_pseudo_inverse() -> None:
    J = np.random.default_rng(0).normal(size=(6, 7))
    np.testing.assert_allclose(damped_inverse(J), np.linalg.pinv(J), atol=0.05)
    np.testing.assert_allclose(damped_inverse(1e3 * J), np.linalg.pinv(1e3 * J), rtol=1e-6)


@pytest.mark.parametrize("s", [0.0, 1e-6, 1e-2, 1.0])
def test_a_singular_value_s_is_inverted_as_s_by_s_squared_and_the_damping(s: float) -> None:
    J = np.diag([1.0, s])
    assert damped_inverse(J)[1, 1] == pytest.approx(s / (s**2 + DAMPING))
    assert np.linalg.eigvalsh(damped_square(J)).min() >= DAMPING
