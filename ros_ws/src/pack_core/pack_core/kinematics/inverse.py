"""What every closed-form inverse offers: all branches, the one that stays, the turns in the limits."""

from __future__ import annotations

from abc import ABC, abstractmethod
from itertools import product

import numpy as np
import numpy.typing as npt

from pack_core.kinematics.chain import SerialChain
from pack_core.rotations import Array, Pose, to_matrix

TURN = 2.0 * np.pi
Branch = tuple[int, int, int]
"""Shoulder, elbow and wrist: which of both solutions, 0 or 1 each."""
BRANCHES: tuple[Branch, ...] = tuple((s, e, w) for s, e, w in product((0, 1), repeat=3))
Bools = npt.NDArray[np.bool_]


class InverseKinematics(ABC):
    """Inverse of a six-joint chain.

    Args:
        chain: the arm and its tool.
        lower: joint limits `(6,)` [rad].
        upper: joint limits `(6,)` [rad].
    """

    def __init__(self, chain: SerialChain, lower: Array, upper: Array) -> None:
        self.chain, self.lower, self.upper = chain, np.array(lower), np.array(upper)

    @abstractmethod
    def _rows(self, R_06: Array, p_06: Array) -> tuple[Array, Bools]:
        """Solutions `(8, 6)` by branch, limits aside, and which of them exist `(8,)`.

        Args:
            R_06: rotation of the last link from where all joints are zero.
            p_06: translation of the last link from there.
        """

    @abstractmethod
    def branch(self, q: Array) -> Branch:
        """The branch that joint positions belong to."""

    def solve(self, X_WT: Pose) -> dict[Branch, Array]:
        """Joint positions `(6,)` in (-pi, pi] that bring the tool to a pose, limits aside, by branch."""
        rows, found = self._solutions(X_WT)
        return {branch: rows[i] for i, branch in enumerate(BRANCHES) if found[i]}

    def follow(self, X_WT: Pose, q_near: Array, branch: Branch) -> Array | None:
        """The solution of a branch, turned next to `q_near` `(6,)`; None without one in the limits."""
        R = to_matrix(X_WT.q)
        return self.follow_matrix(R, X_WT.p, q_near, branch)

    def follow_matrix(self, R_WT: Array, p_WT: Array, q_near: Array, branch: Branch) -> Array | None:
        """As `follow`, for a pose given as matrix and position."""
        rows, found = self._rows(*self._last_link(R_WT, p_WT))
        i = 4 * branch[0] + 2 * branch[1] + branch[2]
        if not found[i]:
            return None
        q: Array = rows[i] + TURN * np.round((q_near - rows[i]) / TURN)
        return q if self.is_within(q) else None

    def candidates(self, X_WT: Pose, shoulder: int, elbow: int) -> list[Array]:
        """Every wrist flip and every turn in the limits, shoulder and elbow given."""
        found = [q for (s, e, _), q in self.solve(X_WT).items() if (s, e) == (shoulder, elbow)]
        return [turned for q in found for turned in self._turns(q)]

    def is_within(self, q: Array) -> bool:
        """Whether joint positions keep the limits."""
        return bool(np.all(q >= self.lower) and np.all(q <= self.upper))

    def _turns(self, q: Array) -> list[Array]:
        ranges = [
            [angle + TURN * k for k in (-1, 0, 1) if low <= angle + TURN * k <= high]
            for angle, low, high in zip(q, self.lower, self.upper, strict=True)
        ]
        return [np.array(turned) for turned in product(*ranges)]

    def _solutions(self, X_WT: Pose) -> tuple[Array, Bools]:
        rows, found = self._rows(*self._last_link(to_matrix(X_WT.q), X_WT.p))
        return (rows + np.pi) % TURN - np.pi, found

    def _last_link(self, R_WT: Array, p_WT: Array) -> tuple[Array, Array]:
        R = np.ascontiguousarray(R_WT @ self.chain.R_WT.T)
        return R, p_WT - R @ self.chain.p_WT
