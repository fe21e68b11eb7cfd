"""The tree of policies: pulled back into joint space, summed, and resolved.

A policy `(a, M)` on a task `x = psi(q)` with Jacobian J adds `J^T M (a - Jdot v)` to the force and
`J^T M J` to the metric of the joints.
"""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

from pack_core.kinematics import screws
from pack_core.rotations import Array
from pack_motion.rmpflow import policies
from pack_motion.rmpflow.box_distance import box_distance, distance_curvature
from pack_motion.rmpflow.parameters import Policies

Indices = npt.NDArray[np.int64]


@numba.njit(cache=True)
def joint_policies(
    q: Array, v: Array, q_ref: Array, v_ref: Array, a_ref: Array,
    lower: Array, upper: Array, velocity: Array, c: Policies, M: Array, f: Array,
) -> None:  # fmt: skip
    """Adds posture, ends of ranges and speed limits to `M` and `f`."""
    a = policies.cspace_target(q_ref - q, v_ref - v, a_ref, c.cspace_target)
    cap = c.joint_velocity_cap
    for i in range(len(q)):
        M[i, i] += c.cspace_target.metric_scalar + c.cspace_target.inertia
        f[i] += c.cspace_target.metric_scalar * a[i] + c.cspace_target.inertia * a_ref[i]
        span = upper[i] - lower[i]
        for side in (1.0, -1.0):
            x = (q[i] - lower[i] if side > 0.0 else upper[i] - q[i]) / span
            push, weight = policies.joint_limit(x, side * v[i] / span, c.joint_limit)
            M[i, i] += weight / span**2
            f[i] += side * weight * push / span
        highest = cap.max_velocity if cap.max_velocity > 0.0 else velocity[i]
        push, weight = policies.velocity_cap(v[i], highest, cap)
        M[i, i] += weight
        f[i] += weight * push


@numba.njit(cache=True)
def tool_policies(
    J: Array, b: Array, v: Array, x: Array, R: Array, x_ref: Array, R_ref: Array, rate_ref: Array,
    acc_ref: Array, c: Policies, M: Array, f: Array,
) -> None:  # fmt: skip
    """Adds the targets of the tool's point and axes, and its damping, to `M` and `f`.

    Args:
        J: Jacobian of the tool `(6, n)`.
        b: `Jdot v` of the tool `(6,)`.
        v: joint velocities `(n,)`.
        x: the tool's point `(3,)`.
        R: its orientation `(3, 3)`.
        x_ref: where its point should be `(3,)`.
        R_ref: how it should be turned `(3, 3)`.
        rate_ref: how the target moves `(6,)`: linear, then angular.
        acc_ref: how that changes `(6,)`.
        c: parameters.
        M: metric of the joints `(n, n)`, added to.
        f: force of the joints `(n,)`, added to.
    """
    rate = J @ v
    d = x_ref - x
    a, weight = policies.target(d, rate_ref[:3] - rate[:3], acc_ref[:3], c.target)
    J_x = np.ascontiguousarray(J[:3])
    JM = J_x.T @ weight
    M += JM @ J_x
    f += JM @ (a - b[:3])
    speed = np.sqrt(rate[:3] @ rate[:3])
    mass = c.damping.inertia + c.damping.metric_scalar * speed
    M += mass * (J_x.T @ J_x)
    slow = -c.damping.metric_scalar * c.damping.accel_d_gain * speed * speed * rate[:3]
    f += J_x.T @ (slow - mass * b[:3])
    distance = float(np.sqrt(d @ d))
    w, w_ref = rate[3:], rate_ref[3:]
    for k in range(3):
        n, n_ref = np.ascontiguousarray(R[:, k]), np.ascontiguousarray(R_ref[:, k])
        dn, dn_ref = screws.cross(w, n), screws.cross(w_ref, n_ref)
        ddn_ref = screws.cross(acc_ref[3:], n_ref) + screws.cross(w_ref, dn_ref)
        a, scale = policies.axis_target(n_ref - n, dn_ref - dn, ddn_ref, distance, c.axis_target)
        J_n = np.empty((3, len(v)))
        for i in range(len(v)):
            J_n[:, i] = screws.cross(np.ascontiguousarray(J[3:, i]), n)
        bias = screws.cross(b[3:], n) + screws.cross(w, dn)
        M += scale * (J_n.T @ J_n)
        f += scale * (J_n.T @ (a - bias))


@numba.njit(cache=True)
def collision_policies(
    Rs: Array, ds: Array, z: Array, p: Array, v: Array, sphere_link: Indices, sphere_p: Array,
    sphere_radius: Array, box_R: Array, box_p: Array, box_half: Array, box_v: Array, box_radius: Array,
    c: Policies, M: Array, f: Array,
) -> float:  # fmt: skip
    """Adds every sphere and obstacle that are near each other to `M` and `f`; returns the least distance."""
    w, dw, vp, ap = screws.link_motion(z, p, v)
    least = np.inf
    for s in range(len(sphere_link)):
        link = sphere_link[s]
        point = Rs[link] @ sphere_p[s] + ds[link]
        arm = point - p[link]
        swing = screws.cross(w[link], arm)
        velocity = vp[link] + swing
        bias = ap[link] + screws.cross(dw[link], arm) + screws.cross(w[link], swing)
        for o in range(len(box_p)):
            gap, g = box_distance(point, box_R[o], box_p[o], box_half[o])
            x = gap - sphere_radius[s]
            least = min(least, x)
            relative = velocity - box_v[o]
            a, weight = policies.collision(x, g @ relative, box_radius[o], c.collision)
            if weight <= 0.0:
                continue
            row = np.zeros(len(v))
            for i in range(link + 1):
                row[i] = g @ screws.cross(z[i], point - p[i])
            bend = g @ bias + distance_curvature(point, relative, box_R[o], box_p[o], box_half[o])
            M += weight * np.outer(row, row)
            f += weight * (a - bend) * row
    return least


@numba.njit(cache=True)
def pull_back(
    axes: Array, points: Array, R_WT: Array, p_WT: Array, lower: Array, upper: Array, velocity: Array,
    q: Array, v: Array, q_ref: Array, v_ref: Array, a_ref: Array, q_posture: Array, sphere_link: Indices,
    sphere_p: Array, sphere_radius: Array, box_R: Array, box_p: Array, box_half: Array, box_v: Array,
    box_radius: Array, c: Policies,
) -> tuple[Array, Array, float, float]:  # fmt: skip
    """The whole tree: metric `(n, n)`, force `(n,)`, and what became of the tool and the obstacles.

    The last two are the tool's distance from its target and the least distance to an obstacle [m].
    The tool's targets are where the reference joints put it; the posture that the joints are drawn to is
    `q_posture`, which is the reference where it is tracked.
    """
    n = len(q)
    R, d = screws.link_transforms(axes, points, q)
    z, p = screws.world_axes(axes, points, R, d)
    x = R[n - 1] @ p_WT + d[n - 1]
    J, b = screws.jacobian(z, p, x, n - 1), screws.bias(z, p, v, x, n - 1)
    R_r, d_r = screws.link_transforms(axes, points, q_ref)
    z_r, p_r = screws.world_axes(axes, points, R_r, d_r)
    x_r = R_r[n - 1] @ p_WT + d_r[n - 1]
    J_r = screws.jacobian(z_r, p_r, x_r, n - 1)
    acc_r = J_r @ a_ref + screws.bias(z_r, p_r, v_ref, x_r, n - 1)
    M, f = np.zeros((n, n)), np.zeros(n)
    joint_policies(q, v, q_posture, v_ref, a_ref, lower, upper, velocity, c, M, f)
    tool_policies(J, b, v, x, R[n - 1] @ R_WT, x_r, R_r[n - 1] @ R_WT, J_r @ v_ref, acc_r, c, M, f)
    least = collision_policies(
        R,
        d,
        z,
        p,
        v,
        sphere_link,
        sphere_p,
        sphere_radius,
        box_R,
        box_p,
        box_half,
        box_v,
        box_radius,
        c,
        M,
        f,
    )
    return M, f, float(np.sqrt((x_r - x) @ (x_r - x))), least
