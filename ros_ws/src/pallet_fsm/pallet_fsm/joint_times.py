"""Estimates how long the arm's joints take from one pose of the tool to another."""

from __future__ import annotations

from functools import cache

import numpy as np

from pack_core.palletizing.arm import arm_kinematics
from pack_core.robots.joint_properties import step_effort
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import Array, Pose

TURNS = 2.0 * np.pi * np.array([[-1.0], [0.0], [1.0]])
"""By which a joint may be turned farther [rad]."""


def joint_time(X_from: Pose, X_to: Pose) -> float:
    """Estimated time from one tool pose to another, each at rest [s]; infinite where one is out of reach.

    Shoulder and elbow stay as they are at home. Which of both flips the wrist has at the start makes no
    difference: the steps from the other one are the same, with the flips at the end exchanged.
    """
    starts, ends = _postures(X_from), _postures(X_to)
    if not starts or not ends:
        return float("inf")
    flip, q = starts[0]
    return min(_effort(q_end - q, q, is_flip=flip_end != flip) for flip_end, q_end in ends)


def warm_up() -> None:
    """Have numba compile the inverse kinematics before the first box; loads it where that was done before."""
    arm = arm_kinematics()
    X_WT = arm.chain.forward(arm.home)
    joint_time(X_WT, X_WT)


def _postures(X_WT: Pose) -> list[tuple[int, Array]]:
    """Flip of the wrist and joint positions `(6,)` [rad] with shoulder and elbow as at home."""
    inverse, home = arm_kinematics().inverse, _home_branch()
    return [(branch[2], q) for branch, q in inverse.solve(X_WT).items() if branch[:2] == home]


@cache
def _home_branch() -> tuple[int, int]:
    arm = arm_kinematics()
    return arm.inverse.branch(arm.home)[:2]


def _effort(step: Array, q: Array, *, is_flip: bool) -> float:
    """Time of a step from `q`, each joint turned as is nearest within its range [s], with penalties."""
    steps = step + TURNS
    is_allowed = (q + steps >= LIMITS.lower) & (q + steps <= LIMITS.upper)
    shortest = np.where(is_allowed, np.abs(steps), np.inf).min(axis=0)
    return step_effort(shortest, LIMITS.velocity, LIMITS.acceleration, is_flip=is_flip)
