"""Parameters of the policies: `config/motion/*.yaml`; names and units as in the tuning guide of Lula."""

from __future__ import annotations

from typing import NamedTuple


class PointTarget(NamedTuple):
    """Draws the tool's point to its target."""

    accel_p_gain: float
    """[m/s^2]"""
    accel_d_gain: float
    """[1/s]"""
    accel_norm_eps: float
    """Distance below which the pull weakens [m]."""
    metric_alpha_length_scale: float
    """Distance over which the metric turns from direction only to all directions [m]."""
    min_metric_alpha: float
    max_metric_scalar: float
    min_metric_scalar: float
    proximity_metric_boost_scalar: float
    proximity_metric_boost_length_scale: float
    """[m]"""


class AxisTarget(NamedTuple):
    """Draws each axis of the tool to its target."""

    accel_p_gain: float
    """[1/s^2]"""
    accel_d_gain: float
    """[1/s]"""
    metric_scalar: float
    proximity_metric_boost_scalar: float
    proximity_metric_boost_length_scale: float
    """[m]"""


class CspaceTarget(NamedTuple):
    """Draws the joints to a posture."""

    metric_scalar: float
    position_gain: float
    """[1/s^2]"""
    damping_gain: float
    """[1/s]"""
    robust_position_term_thresh: float
    """[rad]"""
    inertia: float


class JointLimitPush(NamedTuple):
    """Keeps each joint off both ends of its range; distances as shares of the range."""

    metric_scalar: float
    metric_length_scale: float
    metric_exploder_eps: float
    metric_velocity_gate_length_scale: float
    accel_damper_gain: float
    accel_potential_gain: float
    accel_potential_exploder_length_scale: float
    accel_potential_exploder_eps: float


class JointVelocityCap(NamedTuple):
    """Slows each joint near its highest speed."""

    max_velocity: float
    """The same for all joints [rad/s]; 0: each joint's own limit."""
    velocity_damping_region: float
    """[rad/s]"""
    damping_gain: float
    """[1/s]"""
    metric_weight: float


class Collision(NamedTuple):
    """Keeps spheres of the arm off obstacles."""

    damping_gain: float
    """[1/s]"""
    damping_std_dev: float
    """[m]"""
    damping_robustness_eps: float
    damping_velocity_gate_length_scale: float
    """[m/s]"""
    repulsion_gain: float
    """[m/s^2]"""
    repulsion_std_dev: float
    """[m]"""
    metric_modulation_radius: float
    """Distance at which obstacles that move are felt [m]."""
    radius_per_speed: float
    """So much farther they are felt for their speed [s]."""
    standing_radius: float
    """Distance at which obstacles that stand are felt [m]; 0: moves are planned around them."""
    avoiding_radius: float
    """The same, for the arm's base as well, while something that moves drives the arm off its way [m]."""
    metric_scalar: float
    metric_exploder_std_dev: float
    """[m]"""
    metric_exploder_eps: float


class Damping(NamedTuple):
    """Damps the tool's point."""

    accel_d_gain: float
    """[1/m]"""
    metric_scalar: float
    inertia: float


class Policies(NamedTuple):
    """One tuning of all policies."""

    target: PointTarget
    axis_target: AxisTarget
    cspace_target: CspaceTarget
    joint_limit: JointLimitPush
    joint_velocity_cap: JointVelocityCap
    collision: Collision
    damping: Damping
