from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose, exp, to_matrix
from pack_motion.arm.arm import MotionArm
from pack_motion.rmpflow import policies
from pack_motion.rmpflow.parameters import Policies
from pack_motion.rmpflow.spheres import Spheres, arm_spheres
from pack_motion.rmpflow.tree import JointGoal, JointMotion, arm_arrays, pull_back
from pack_motion.tracking.config import motion_set
from pack_motion.tracking.obstacles import ObstacleField

C = motion_set("table_4_1").fast
SILENT = C._replace(
    target=C.target._replace(max_metric_scalar=0.0, min_metric_scalar=0.0),
    axis_target=C.axis_target._replace(metric_scalar=0.0),
    cspace_target=C.cspace_target._replace(metric_scalar=0.0, inertia=0.0),
    joint_limit=C.joint_limit._replace(metric_scalar=0.0),
    joint_velocity_cap=C.joint_velocity_cap._replace(metric_weight=0.0),
    damping=C.damping._replace(metric_scalar=0.0, inertia=0.0),
)
rates = st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6).map(np.array)
Q = np.array([0.3, -1.2, 1.4, 0.5, 0.8, -0.4])


def tree(
    arm: MotionArm, c: Policies, q: Array, v: Array, q_ref: Array, v_ref: Array, a_ref: Array,
    obstacles: tuple[Obstacle, ...] = (), spheres: Spheres | None = None,
) -> tuple[Array, Array, float, float]:  # fmt: skip
    boxes, goal = ObstacleField.of(obstacles, c.collision).boxes, JointGoal(q_ref, v_ref, a_ref, q_ref)
    return pull_back(arm_arrays(arm), JointMotion(q, v), goal, spheres or arm_spheres(arm, 5), boxes, c)


@given(v=rates, step=rates)
@settings(max_examples=20)
def test_point_and_axes_get_the_accelerations_they_ask_for(arm: MotionArm, v: Array, step: Array) -> None:
    """Six tasks for six joints: whatever their weights, all are met, and `Jdot v` is accounted for."""
    c = SILENT._replace(
        target=C.target._replace(min_metric_alpha=1.0, proximity_metric_boost_scalar=1.0),
        axis_target=C.axis_target._replace(proximity_metric_boost_scalar=1.0),
    )
    q_ref = Q + 1e-3 * step
    M, f, deviation, _ = tree(arm, c, Q, v, q_ref, np.zeros(6), np.zeros(6))
    a = np.linalg.solve(M, f)
    p, p_ref = arm.chain.forward(Q).p, arm.chain.forward(q_ref).p
    moved = arm.chain.jacobian(Q) @ a + arm.chain.bias(Q, v)
    asked, _ = policies.target(p_ref - p, -(arm.chain.jacobian(Q) @ v)[:3], np.zeros(3), c.target)
    np.testing.assert_allclose(moved[:3], asked, rtol=1e-4, atol=1e-4 * np.abs(asked).max() + 1e-6)
    assert np.isclose(deviation, np.linalg.norm(p_ref - p))


@given(v=rates, a_ref=rates)
@settings(max_examples=20)
def test_a_reference_that_is_kept_up_with_is_followed_exactly(arm: MotionArm, v: Array, a_ref: Array) -> None:
    c = motion_set("shipped").fast
    M, f, _, _ = tree(arm, c, Q, 0.5 * v, Q, 0.5 * v, a_ref)
    np.testing.assert_allclose(np.linalg.solve(M, f), a_ref, atol=2e-3)


def test_the_metric_is_symmetric_and_positive(arm: MotionArm) -> None:
    wall = Obstacle("wall", Pose(arm.chain.forward(Q).p + np.array([0.0, 0.0, -0.3])), np.full(3, 0.2))
    M, _, _, least = tree(arm, C, Q, np.full(6, 0.3), Q + 0.1, np.zeros(6), np.zeros(6), (wall,))
    np.testing.assert_allclose(M, M.T, rtol=1e-9, atol=1e-9 * np.abs(M).max())
    assert np.linalg.eigvalsh(M).min() > 0.0
    assert np.isfinite(least)


def test_an_obstacle_alone_accelerates_the_nearest_sphere_away_from_it(arm: MotionArm) -> None:
    p = arm.chain.forward(Q).p
    sphere = Spheres(np.array([5]), arm.chain.p_WT[None].copy(), np.array([0.01]))
    R = to_matrix(exp(np.array([0.2, 0.1, 0.4])))
    wall = Obstacle(
        "wall", Pose(p - 0.2 * R[:, 0], exp(np.array([0.2, 0.1, 0.4]))), np.array([0.2, 2.0, 2.0])
    )
    v = np.array([0.2, -0.1, 0.1, 0.3, -0.2, 0.1])
    M, f, _, least = tree(arm, SILENT, Q, v, Q, v, np.zeros(6), (wall,), sphere)
    a = np.linalg.pinv(M, rcond=1e-9, hermitian=True) @ f
    rate = (arm.chain.jacobian(Q) @ v)[:3]
    moved = (arm.chain.jacobian(Q) @ a + arm.chain.bias(Q, v))[:3]
    asked, weight = policies.collision(0.09, float(R[:, 0] @ rate), C.collision.standing_radius, C.collision)
    assert np.isclose(least, 0.09)
    assert weight > 0.0
    assert np.isclose(R[:, 0] @ moved, asked, rtol=1e-6)


def test_the_carried_box_has_spheres_within_it(arm: MotionArm) -> None:
    box = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), np.array([0.4, 0.3, 0.2]))
    spheres = arm_spheres(arm, 2)
    both = spheres.with_carried(arm, box)
    added = both.p[len(spheres.p) :]
    assert len(added) == 8 + 6 + 4
    p_T = (added - arm.chain.p_WT) @ arm.chain.R_WT - box.X_TB.p
    assert np.all(np.abs(p_T) + both.radius[len(spheres.p) :, None] <= 0.5 * box.size + 1e-9)
