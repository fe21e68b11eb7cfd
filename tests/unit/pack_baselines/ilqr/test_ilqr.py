"""The optimizer on problems with known answers."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_baselines.ilqr.ilqr import IlqrConfig, cheapest, iterate
from pack_mpc.cost.cost import Expansion
from pack_mpc.plant import Linearization

CONFIG = IlqrConfig(regularisation_min=1e-12)


class Pendulum:
    """A damped pendulum, or its linearisation about the bottom."""

    def __init__(self, *, is_linear: bool, limit: float = 1e9) -> None:
        self.limits = np.array([limit])
        self._is_linear = is_linear

    def _step(self, x: np.ndarray, u: np.ndarray) -> np.ndarray:
        angle = x[..., 0] if self._is_linear else np.sin(x[..., 0])
        v = x[..., 1] + 0.05 * (-9.81 * angle - 0.2 * x[..., 1] + u[..., 0])
        return np.stack([x[..., 0] + 0.05 * v, v], axis=-1)

    def rollout(self, x0: np.ndarray, us: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        xs = [np.broadcast_to(x0, (len(us), 2))]
        for t in range(us.shape[1]):
            xs.append(self._step(xs[-1], us[:, t]))
        return np.stack(xs, axis=1), np.stack(xs, axis=1)

    def linearize(self, xs, us, columns, keypoints) -> Linearization:
        slope = np.ones(len(us)) if self._is_linear else np.cos(xs[:-1, 0])
        A = np.zeros((len(us), 2, 2))
        A[:, 1, 0], A[:, 1, 1] = -0.05 * 9.81 * slope, 1 - 0.05 * 0.2
        A[:, 0, 0], A[:, 0, 1] = 1 + 0.05 * A[:, 1, 0], 0.05 * A[:, 1, 1]
        B = np.tile([[0.05 * 0.05], [0.05]], (len(us), 1, 1))
        C = np.tile(np.eye(2), (len(us) + 1, 1, 1))
        return Linearization(A, B, C, np.zeros((len(us), 2, 1)))


class Quadratic:
    """x' Q x + u' R u, with a heavier end."""

    Q, Qf, R = np.diag([1.0, 0.1]), np.diag([50.0, 5.0]), np.array([[0.05]])

    def value(self, xs: np.ndarray, ys: np.ndarray, us: np.ndarray) -> np.ndarray:
        running = np.einsum("btx,xy,bty->b", xs[:, :-1], self.Q, xs[:, :-1])
        end = np.einsum("bx,xy,by->b", xs[:, -1], self.Qf, xs[:, -1])
        return running + end + np.einsum("btu,uv,btv->b", us, self.R, us)

    def expand(self, xs, ys, us, lin, columns) -> Expansion:
        steps = len(us)
        lxx = np.concatenate([np.tile(2 * self.Q, (steps, 1, 1)), 2 * self.Qf[None]])
        return Expansion(
            np.einsum("txy,ty->tx", lxx, xs), lxx, 2 * us @ self.R, np.tile(2 * self.R, (steps, 1, 1)),
            np.zeros((steps, 1, 2)),
        )  # fmt: skip


def riccati(plant: Pendulum, steps: int, x0: np.ndarray) -> np.ndarray:
    """Optimal controls by the discrete Riccati recursion."""
    lin = plant.linearize(np.zeros((steps + 1, 2)), np.zeros((steps, 1)), np.arange(2), np.array([0, steps]))
    P, gains = Quadratic.Qf, []
    for t in reversed(range(steps)):
        A, B = lin.A[t], lin.B[t]
        K = scipy.linalg.solve(Quadratic.R + B.T @ P @ B, B.T @ P @ A)
        P = Quadratic.Q + A.T @ P @ (A - B @ K)
        gains.append(K)
    x, us = x0, []
    for t, K in enumerate(reversed(gains)):
        us.append(-K @ x)
        x = lin.A[t] @ x + lin.B[t] @ us[-1]
    return np.array(us)


def test_one_iteration_solves_a_linear_problem_as_lqr_does() -> None:
    plant, cost, x0 = Pendulum(is_linear=True), Quadratic(), np.array([1.0, -0.5])
    nominal = cheapest(plant, cost, x0, np.zeros((40, 1))[None])[0]
    result = iterate(plant, cost, nominal, np.arange(2), 1e-12, CONFIG)
    np.testing.assert_allclose(result.trajectory.us, riccati(plant, 40, x0), atol=1e-8)


@settings(max_examples=40)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.5, 20), st.integers(0, 10_000))
def test_iterations_never_raise_the_cost(angle: float, speed: float, limit: float, seed: int) -> None:
    plant, cost = Pendulum(is_linear=False, limit=limit), Quadratic()
    us = np.random.default_rng(seed).uniform(-limit, limit, (40, 1))
    trajectory, regularisation = cheapest(plant, cost, np.array([angle, speed]), us[None])[0], 1e-6
    for _ in range(8):
        result = iterate(plant, cost, trajectory, np.arange(2), regularisation, CONFIG)
        assert result.trajectory.cost <= trajectory.cost
        assert np.all(np.abs(result.trajectory.us) <= limit)
        trajectory, regularisation = result.trajectory, result.regularisation


def test_derivatives_that_are_not_finite_leave_the_trajectory_as_it_is() -> None:
    class Broken(Pendulum):
        def linearize(self, xs, us, columns, keypoints) -> Linearization:
            lin = super().linearize(xs, us, columns, keypoints)
            lin.A[3, 0, 0] = np.nan
            return lin

    plant, cost = Broken(is_linear=True), Quadratic()
    nominal = cheapest(plant, cost, np.array([1.0, 0.0]), np.zeros((10, 1))[None])[0]
    result = iterate(plant, cost, nominal, np.arange(2), 1e-6, CONFIG)
    assert result.trajectory is nominal
    assert "not finite" in result.warning


def test_a_line_search_that_finds_nothing_better_keeps_the_trajectory_and_regularises_more() -> None:
    plant, cost, x0 = Pendulum(is_linear=True), Quadratic(), np.array([1.0, -0.5])
    best = cheapest(plant, cost, x0, riccati(plant, 40, x0)[None])[0]
    result = iterate(plant, cost, best, np.arange(2), 1e-6, CONFIG)
    assert result.trajectory.cost == pytest.approx(best.cost)
    assert result.step_size == 0.0 or result.trajectory.cost <= best.cost
