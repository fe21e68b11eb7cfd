"""The least distance problem: feasible exactly when a linear program says so, and the shortest of all."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize

from pack_planner.layout.axis_program import least_distance


@given(seed=st.integers(0, 10_000), rows=st.integers(1, 12), columns=st.integers(1, 6))
def test_it_is_feasible_where_a_linear_program_is_and_no_longer_than_a_general_solver_says(
    seed: int, rows: int, columns: int
) -> None:
    rng = np.random.default_rng(seed)
    G, h = rng.normal(size=(rows, columns)), rng.normal(size=rows)
    x = least_distance(G, h)
    program = linprog(np.zeros(columns), A_ub=-G, b_ub=-h, bounds=(None, None))
    assert (x is not None) == (program.status == 0)
    if x is not None:
        assert np.all(G @ x >= h - 1e-6)
        constraint = {"type": "ineq", "fun": lambda y: G @ y - h, "jac": lambda y: G}
        general = minimize(lambda y: y @ y, program.x, jac=lambda y: 2 * y, constraints=constraint, tol=1e-12)
        assert x @ x <= general.fun * (1 + 1e-5) + 1e-9


def test_one_inequality_gives_the_foot_of_the_perpendicular() -> None:
    x = least_distance(np.array([[3.0, 4.0]]), np.array([10.0]))
    np.testing.assert_allclose(x, [1.2, 1.6])


def test_what_holds_at_the_origin_needs_no_step() -> None:
    np.testing.assert_allclose(least_distance(np.eye(2), np.array([-1.0, 0.0])), [0.0, 0.0], atol=1e-12)


def test_a_contradiction_has_no_solution() -> None:
    assert least_distance(np.array([[1.0], [-1.0]]), np.array([1.0, 0.0])) is None
