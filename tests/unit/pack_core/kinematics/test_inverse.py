from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pack_core.errors import PackError
from pack_core.kinematics.chain import SerialChain
from pack_core.kinematics.inverse import InverseKinematics
from pack_core.kinematics.parallel_axes import ParallelAxes
from pack_core.kinematics.spherical_wrist import SphericalWrist
from pack_core.robots import kr210, ur10e
from pack_core.rotations import Array, Pose, angle_between, to_matrix

unit = st.lists(st.floats(0.02, 0.98), min_size=6, max_size=6).map(np.array)
TWICE = 2 * np.pi


@pytest.fixture(scope="session", params=["kr210", "ur10e"])
def inverse(request: pytest.FixtureRequest) -> InverseKinematics:
    if request.param == "kr210":
        chain = request.getfixturevalue("kr210_chain")
        return SphericalWrist(chain, kr210.LIMITS.lower, kr210.LIMITS.upper)
    chain = request.getfixturevalue("ur10e_chain")
    return ParallelAxes(chain, ur10e.LIMITS.lower, ur10e.LIMITS.upper)


def within_limits(inverse: InverseKinematics, share: Array) -> Array:
    q: Array = inverse.lower + share * (inverse.upper - inverse.lower)
    return q


def is_regular(inverse: InverseKinematics, q: Array) -> bool:
    return float(np.linalg.cond(inverse.chain.jacobian(q))) < 1e3


def is_at(inverse: InverseKinematics, q: Array, X_WT: Pose) -> bool:
    X = inverse.chain.forward(q)
    return bool(np.abs(X.p - X_WT.p).max() < 1e-7) and float(angle_between(X.q, X_WT.q)) < 1e-6


@given(share=unit)
@settings(max_examples=100)
def test_every_solution_reaches_the_pose(inverse: InverseKinematics, share: Array) -> None:
    X_WT = inverse.chain.forward(within_limits(inverse, share))
    solutions = inverse.solve(X_WT)
    assert solutions
    assert all(is_at(inverse, q, X_WT) for q in solutions.values())


@given(share=unit, elbow=st.sampled_from([0.5, 0.6]), wrist=st.sampled_from([0.25, 0.5, 0.75]))
@settings(max_examples=200)
def test_a_pose_in_the_wrist_singularity_has_solutions_whatever_the_elbow(
    ur10e_chain: SerialChain, share: Array, elbow: float, wrist: float
) -> None:
    """Axes 2, 3, 4 and 6 are parallel: joint 6 may turn anyhow, but a stretched arm reaches one way alone."""
    inverse = ParallelAxes(ur10e_chain, ur10e.LIMITS.lower, ur10e.LIMITS.upper)
    share[[2, 4]] = elbow, wrist
    X_WT = inverse.chain.forward(within_limits(inverse, share))
    solutions = inverse.solve(X_WT)
    assert solutions
    assert all(is_at(inverse, q, X_WT) for q in solutions.values())


@given(share=unit)
@settings(max_examples=100)
def test_the_branch_of_joint_positions_leads_back_to_them(inverse: InverseKinematics, share: Array) -> None:
    q = within_limits(inverse, share)
    assume(is_regular(inverse, q))
    found = inverse.follow(inverse.chain.forward(q), q, inverse.branch(q))
    assert found is not None
    np.testing.assert_allclose(found, q, atol=1e-6)


@given(share=unit, step=unit)
@settings(max_examples=50)
def test_rows_of_one_branch_are_those_that_are_followed_pose_by_pose(
    inverse: InverseKinematics, share: Array, step: Array
) -> None:
    q = within_limits(inverse, share)
    assume(is_regular(inverse, q))
    branch = inverse.branch(q)
    poses = [inverse.chain.forward(q + 0.01 * k * (step - 0.5)) for k in range(5)]
    rows = inverse.follow_rows(
        np.array([to_matrix(X.q) for X in poses]), np.array([X.p for X in poses]), q, branch
    )
    near, expected = q, []
    for X_WT in poses:
        found = inverse.follow(X_WT, near, branch)
        if found is None:
            break
        expected.append(near := found)
    np.testing.assert_allclose(rows, np.array(expected).reshape(-1, 6), atol=1e-12)


@given(share=unit)
@settings(max_examples=50)
def test_solutions_lie_on_the_branch_they_are_named_by(inverse: InverseKinematics, share: Array) -> None:
    q = within_limits(inverse, share)
    assume(is_regular(inverse, q))
    for branch, solution in inverse.solve(inverse.chain.forward(q)).items():
        assert inverse.branch(solution) == branch


def test_candidates_hold_all_flips_and_turns_of_the_wrist(inverse: InverseKinematics) -> None:
    q = within_limits(inverse, np.array([0.45, 0.4, 0.6, 0.52, 0.6, 0.55]))
    X_WT, (shoulder, elbow, _) = inverse.chain.forward(q), inverse.branch(q)
    candidates = inverse.candidates(X_WT, shoulder, elbow)
    assert any(np.allclose(found, q, atol=1e-6) for found in candidates)
    assert len(candidates) >= 4
    for found in candidates:
        assert inverse.is_within(found)
        assert is_at(inverse, found, X_WT)


def test_a_pose_out_of_reach_has_no_solution(inverse: InverseKinematics) -> None:
    X_WT = Pose(inverse.chain.p_WT + np.array([9.0, 0.0, 0.0]))
    assert inverse.solve(X_WT) == {}
    assert inverse.follow(X_WT, np.zeros(6), (0, 0, 0)) is None


def test_each_inverse_refuses_the_other_arm(kr210_chain: SerialChain, ur10e_chain: SerialChain) -> None:
    with pytest.raises(PackError):
        SphericalWrist(ur10e_chain, ur10e.LIMITS.lower, ur10e.LIMITS.upper)
    with pytest.raises(PackError):
        ParallelAxes(kr210_chain, kr210.LIMITS.lower, kr210.LIMITS.upper)
