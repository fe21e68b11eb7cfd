"""The policies, compiled: each an acceleration and a metric `(a, M)` in its own task space.

Every target may move: its velocity and acceleration are fed forward, and drop out when it stands still.
"""

from __future__ import annotations

import numba
import numpy as np

from pack_core.rotations import Array
from pack_motion.rmpflow.parameters import (
    AxisTarget,
    Collision,
    CspaceTarget,
    JointLimitPush,
    JointVelocityCap,
    PointTarget,
)

TINY = 1e-12
"""Guards a division by the square of a distance that may be zero [m^2]."""


@numba.njit(cache=True)
def sigmoid(y: float) -> float:
    """Rises from 0 to 1 around 0."""
    return float(1.0 / (1.0 + np.exp(-min(max(y, -500.0), 500.0))))


@numba.njit(cache=True)
def boost(distance: float, scalar: float, length_scale: float) -> float:
    """Factor of a metric near the target: `scalar` there, 1 far away."""
    near = np.exp(-(distance**2) / (2.0 * length_scale**2))
    return float(scalar * near + 1.0 - near)


@numba.njit(cache=True)
def target(d: Array, dd: Array, ddx_target: Array, c: PointTarget) -> tuple[Array, Array]:
    """Point target: the target tracking policy of the thesis (Eq. 4.7), with a pull that is normalised.

    The thesis prints a spring and a damper, `a = -K_p (p_ee - p_des) - K_d dp_ee`. This is, with
    `d = p_des - p_ee` and for a target at rest `dd = -dp_ee`, Lula's policy instead:

        a = K_p d / (|d| + eps) + K_d dd

    It has to be, for the thesis runs Lula and gives Lula's parameters: `eps` (`accel_norm_eps`) has a place
    only here. The pull is bounded by `K_p` [m/s^2] however far the target is, so that the tool approaches
    at `K_p / K_d` [m/s]; as printed, the speed would grow with the distance. Near the target the pull is
    stiffer than printed, by up to `1 / eps`: with Table 4.1, 165 instead of 14 m/s^2 at 1 cm.

    Args:
        d: from the tool to the target `(3,)` [m].
        dd: velocity of the target relative to the tool `(3,)` [m/s].
        ddx_target: acceleration of the target `(3,)` [m/s^2].
        c: parameters.

    Returns:
        The acceleration `(3,)` [m/s^2] and its metric `(3, 3)`: far away the metric weighs the direction of
        the target only, so that other policies may bend the way; near it, all directions alike.
    """
    r = float(np.sqrt(d @ d))
    a = ddx_target + c.accel_p_gain * d / (r + c.accel_norm_eps) + c.accel_d_gain * dd
    near = np.exp(-(r**2) / (2.0 * c.metric_alpha_length_scale**2))
    alpha = (1.0 - c.min_metric_alpha) * near + c.min_metric_alpha
    M = alpha * c.max_metric_scalar * np.eye(3)
    M += (1.0 - alpha) * c.min_metric_scalar * np.outer(d, d) / (r * r + TINY)
    return a, boost(r, c.proximity_metric_boost_scalar, c.proximity_metric_boost_length_scale) * M


@numba.njit(cache=True)
def axis_target(
    d: Array, dd: Array, ddn_target: Array, distance: float, c: AxisTarget
) -> tuple[Array, float]:
    """Axis target: `d`, `dd` as for the point; the metric is a multiple of the identity."""
    a = ddn_target + c.accel_p_gain * d + c.accel_d_gain * dd
    return a, c.metric_scalar * boost(
        distance, c.proximity_metric_boost_scalar, c.proximity_metric_boost_length_scale
    )


@numba.njit(cache=True)
def cspace_target(d: Array, dd: Array, ddq_target: Array, c: CspaceTarget) -> Array:
    """Posture: its pull is bounded; the metric is `metric_scalar` times the identity."""
    size = np.sqrt(d @ d)
    pull = d if size < c.robust_position_term_thresh else d * (c.robust_position_term_thresh / size)
    return ddq_target + c.position_gain * pull + c.damping_gain * dd


@numba.njit(cache=True)
def joint_limit(x: float, dx: float, c: JointLimitPush) -> tuple[float, float]:
    """One end of a joint's range: `x` is the distance to it as a share of the range, `dx` its rate."""
    length, eps = c.accel_potential_exploder_length_scale, c.accel_potential_exploder_eps
    a = c.accel_potential_gain / (x * x / length**2 + eps) - c.accel_damper_gain * dx
    gate = 1.0 - sigmoid(dx / c.metric_velocity_gate_length_scale)
    return a, gate * c.metric_scalar / (max(x, 0.0) / c.metric_length_scale + c.metric_exploder_eps)


@numba.njit(cache=True)
def velocity_cap(dq: float, highest: float, c: JointVelocityCap) -> tuple[float, float]:
    """One joint's speed limit; the metric explodes at it."""
    excess = abs(dq) - (highest - c.velocity_damping_region)
    if excess <= 0.0:
        return 0.0, 0.0
    share = min(excess / c.velocity_damping_region, 0.999)
    return -c.damping_gain * np.sign(dq) * excess, c.metric_weight / (1.0 - share * share)


@numba.njit(cache=True)
def collision(x: float, dx: float, radius: float, c: Collision) -> tuple[float, float]:
    """One sphere and one obstacle: `x` is the distance between them, `dx` its rate."""
    if x >= radius:
        return 0.0, 0.0
    distance = max(x, 0.0)
    gate = 1.0 - sigmoid(dx / c.damping_velocity_gate_length_scale)
    a = c.repulsion_gain * np.exp(-distance / c.repulsion_std_dev)
    a -= c.damping_gain * gate * dx / (distance / c.damping_std_dev + c.damping_robustness_eps)
    window = (distance / radius - 1.0) ** 2
    weight = c.metric_scalar / (distance / c.metric_exploder_std_dev + c.metric_exploder_eps)
    return a, gate * window * weight
