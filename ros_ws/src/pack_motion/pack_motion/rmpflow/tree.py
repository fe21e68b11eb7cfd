"""The tree of policies: pulled back into joint space and summed.

A policy `(a, M)` on a task `x = psi(q)` with Jacobian J adds `J^T M (a - Jdot v)` to the force and
`J^T M J` to the metric of the joints. What goes through the tree are named tuples of arrays: compiled code
takes them as they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from pack_core.kinematics import screws
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.rmpflow import policies
from pack_motion.rmpflow.parameters import Policies
from pack_motion.rmpflow.spheres import Spheres, box_distance, distance_curvature


class ArmArrays(NamedTuple):
    """An arm of n joints.

    Attributes:
        axes: of the joints where all of them are zero `(n, 3)`.
        points: on these axes `(n, 3)` [m].
        R_WT: orientation of the tool there `(3, 3)`.
        p_WT: point of the tool there `(3,)` [m].
        lower: ends of the joints' ranges `(n,)` [rad].
        upper: likewise.
        velocity: limits of the joints' speeds `(n,)` [rad/s].
    """

    axes: Array
    points: Array
    R_WT: Array
    p_WT: Array
    lower: Array
    upper: Array
    velocity: Array


class JointMotion(NamedTuple):
    """Positions [rad] and velocities [rad/s] of the joints, each `(n,)`."""

    q: Array
    v: Array


class JointGoal(NamedTuple):
    """The reference that the policies are drawn to.

    Attributes:
        q: of the reference `(n,)` [rad]; the tool's targets are where it puts the tool.
        v: likewise [rad/s].
        a: likewise [rad/s^2].
        posture: that the joints are drawn to `(n,)` [rad]: mostly `q`.
    """

    q: Array
    v: Array
    a: Array
    posture: Array


class ToolMotion(NamedTuple):
    """The tool, as it moves or as it should.

    Attributes:
        p: its point `(3,)` [m].
        R: its orientation `(3, 3)`.
        rate: linear and angular velocity `(6,)` [m/s, rad/s].
        acceleration: likewise `(6,)`; of the tool as it moves only what its speed makes, `Jdot v`.
    """

    p: Array
    R: Array
    rate: Array
    acceleration: Array


class LinkMotion(NamedTuple):
    """The links of an arm that moves.

    Attributes:
        R: displacements of the links from where all joints are zero, turn `(n, 3, 3)`.
        d: and shift `(n, 3)` [m].
        axes: of the joints in the world now `(n, 3)`.
        points: on these axes `(n, 3)` [m].
        v: velocities of the joints `(n,)` [rad/s].
    """

    R: Array
    d: Array
    axes: Array
    points: Array
    v: Array


class ObstacleBoxes(NamedTuple):
    """Boxes that the collision policy feels.

    Attributes:
        R: orientations `(k, 3, 3)`.
        p: centres `(k, 3)` [m].
        half: half edge lengths `(k, 3)` [m].
        v: velocities `(k, 3)` [m/s].
        radius: distance at which each is felt `(k,)` [m].
        counts: 1 where the distance to it is reported, 0 where not `(k,)`.
    """

    R: Array
    p: Array
    half: Array
    v: Array
    radius: Array
    counts: Array


class JointPull(NamedTuple):
    """The sum of the policies in joint space, which each adds its part to: metric `(n, n)`, force `(n,)`."""

    M: Array
    f: Array


def arm_arrays(arm: MotionArm) -> ArmArrays:
    """What the tree needs of an arm."""
    chain, limits = arm.chain, arm.limits
    return ArmArrays(
        chain.axes, chain.points, chain.R_WT, chain.p_WT, limits.lower, limits.upper, limits.velocity
    )


@numba.njit(cache=True)
def joint_policies(now: JointMotion, goal: JointGoal, arm: ArmArrays, c: Policies, total: JointPull) -> None:
    """Adds posture, ends of ranges and speed limits to the total."""
    M, f = total.M, total.f
    a = policies.cspace_target(goal.posture - now.q, goal.v - now.v, goal.a, c.cspace_target)
    cap = c.joint_velocity_cap
    for i in range(len(now.q)):
        M[i, i] += c.cspace_target.metric_scalar + c.cspace_target.inertia
        f[i] += c.cspace_target.metric_scalar * a[i] + c.cspace_target.inertia * goal.a[i]
        span = arm.upper[i] - arm.lower[i]
        for side in (1.0, -1.0):  # from the lower end, then from the upper one
            x = (now.q[i] - arm.lower[i] if side > 0.0 else arm.upper[i] - now.q[i]) / span
            push, weight = policies.joint_limit(x, side * now.v[i] / span, c.joint_limit)
            # x is a share of the range: its Jacobian is side / span
            M[i, i] += weight / span**2
            f[i] += side * weight * push / span
        highest = cap.max_velocity if cap.max_velocity > 0.0 else arm.velocity[i]
        push, weight = policies.velocity_cap(now.v[i], highest, cap)
        M[i, i] += weight
        f[i] += weight * push


@numba.njit(cache=True)
def tool_policies(J: Array, now: ToolMotion, goal: ToolMotion, c: Policies, total: JointPull) -> None:
    """Adds the targets of the tool's point and axes, and its damping, to the total.

    Args:
        J: Jacobian of the tool `(6, n)`.
        now: the tool as it moves.
        goal: as it should.
        c: parameters.
        total: of the joints, added to.
    """
    M, f = total.M, total.f
    rate, b = now.rate, now.acceleration
    d = goal.p - now.p
    a, weight = policies.target(d, goal.rate[:3] - rate[:3], goal.acceleration[:3], c.target)
    J_x = np.ascontiguousarray(J[:3])
    JM = J_x.T @ weight
    M += JM @ J_x
    f += JM @ (a - b[:3])
    # the damping's metric grows with the speed, so that it dominates fast motion and leaves slow motion alone
    speed = np.sqrt(rate[:3] @ rate[:3])
    mass = c.damping.inertia + c.damping.metric_scalar * speed
    M += mass * (J_x.T @ J_x)
    slow = -c.damping.metric_scalar * c.damping.accel_d_gain * speed * speed * rate[:3]
    f += J_x.T @ (slow - mass * b[:3])
    distance = float(np.sqrt(d @ d))
    w, w_ref = rate[3:], goal.rate[3:]
    for k in range(3):
        # an axis n that is fixed to the tool moves with dn = w x n
        n, n_ref = np.ascontiguousarray(now.R[:, k]), np.ascontiguousarray(goal.R[:, k])
        dn, dn_ref = screws.cross(w, n), screws.cross(w_ref, n_ref)
        ddn_ref = screws.cross(goal.acceleration[3:], n_ref) + screws.cross(w_ref, dn_ref)
        a, scale = policies.axis_target(n_ref - n, dn_ref - dn, ddn_ref, distance, c.axis_target)
        J_n = np.empty((3, J.shape[1]))
        for i in range(J.shape[1]):
            J_n[:, i] = screws.cross(np.ascontiguousarray(J[3:, i]), n)
        bias = screws.cross(b[3:], n) + screws.cross(w, dn)
        M += scale * (J_n.T @ J_n)
        f += scale * (J_n.T @ (a - bias))


@numba.njit(cache=True)
def collision_policies(
    links: LinkMotion, spheres: Spheres, boxes: ObstacleBoxes, c: Policies, total: JointPull
) -> float:
    """Adds every sphere and obstacle that are near each other; returns the least distance that counts."""
    if len(boxes.p) == 0:  # mostly: moves are planned around what stands
        return np.inf
    M, f, z, p = total.M, total.f, links.axes, links.points
    w, dw, vp, ap = screws.link_motion(z, p, links.v)
    least = np.inf
    for s in range(len(spheres.link)):
        link = spheres.link[s]
        point = links.R[link] @ spheres.p[s] + links.d[link]
        arm = point - p[link]
        swing = screws.cross(w[link], arm)
        velocity = vp[link] + swing
        # acceleration of the point at the joints' present speed, theirs being zero: Jdot v
        bias = ap[link] + screws.cross(dw[link], arm) + screws.cross(w[link], swing)
        for o in range(len(boxes.p)):
            gap, g = box_distance(point, boxes.R[o], boxes.p[o], boxes.half[o])
            x = gap - spheres.radius[s]
            if boxes.counts[o] > 0.0:
                least = min(least, x)
            relative = velocity - boxes.v[o]
            a, weight = policies.collision(x, g @ relative, boxes.radius[o], c.collision)
            if weight <= 0.0:
                continue
            row = np.zeros(len(links.v))
            for i in range(link + 1):  # only joints before the sphere move it
                row[i] = g @ screws.cross(z[i], point - p[i])
            bend = g @ bias + distance_curvature(point, relative, boxes.R[o], boxes.p[o], boxes.half[o])
            M += weight * np.outer(row, row)
            f += weight * (a - bend) * row
    return least


@numba.njit(cache=True)
def pull_back(
    arm: ArmArrays, now: JointMotion, goal: JointGoal, spheres: Spheres, boxes: ObstacleBoxes, c: Policies
) -> tuple[Array, Array, float, float]:
    """The whole tree, pulled back into joint space.

    Args:
        arm: its geometry and limits.
        now: the joints as they move.
        goal: the reference; the tool's targets are where it puts the tool.
        spheres: of the arm and the box in its hand.
        boxes: obstacles.
        c: parameters of the policies.

    Returns:
        Metric `(n, n)` and force `(n,)` of the joints, the tool's distance from its target [m], and the
        least distance from any sphere to any obstacle [m].
    """
    n, v = len(now.q), now.v
    R, d = screws.link_transforms(arm.axes, arm.points, now.q)
    z, p = screws.world_axes(arm.axes, arm.points, R, d)
    x = R[n - 1] @ arm.p_WT + d[n - 1]
    J, b = screws.jacobian(z, p, x, n - 1), screws.bias(z, p, v, x, n - 1)
    R_r, d_r = screws.link_transforms(arm.axes, arm.points, goal.q)
    z_r, p_r = screws.world_axes(arm.axes, arm.points, R_r, d_r)
    x_r = R_r[n - 1] @ arm.p_WT + d_r[n - 1]
    J_r = screws.jacobian(z_r, p_r, x_r, n - 1)
    acc_r = J_r @ goal.a + screws.bias(z_r, p_r, goal.v, x_r, n - 1)
    total = JointPull(np.zeros((n, n)), np.zeros(n))
    joint_policies(now, goal, arm, c, total)
    tool = ToolMotion(x, R[n - 1] @ arm.R_WT, J @ v, b)
    target = ToolMotion(x_r, R_r[n - 1] @ arm.R_WT, J_r @ goal.v, acc_r)
    tool_policies(J, tool, target, c, total)
    least = collision_policies(LinkMotion(R, d, z, p, v), spheres, boxes, c, total)
    return total.M, total.f, float(np.sqrt((x_r - x) @ (x_r - x))), least
