"""What every closed-form inverse offers: all branches, the one that stays, the turns in the limits.

Each kind of arm solves for the same three pairs of angles, by Paden-Kahan subproblems: the shoulder (joint
1), the elbow (joint 3) and the flip of the wrist (joint 5). One of each pair makes a branch.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from itertools import product

import numba
import numpy as np
import numpy.typing as npt

from pack_core.errors import PackError
from pack_core.kinematics import screws
from pack_core.kinematics.chain import SerialChain
from pack_core.kinematics.screws import angles_to_plane
from pack_core.rotations import Array, Pose, to_matrix

TURN = 2.0 * np.pi
"""A whole turn [rad]."""
Branch = tuple[int, int, int]
"""Shoulder, elbow and wrist flip: which of both solutions, 0 or 1 each."""
BRANCHES: tuple[Branch, ...] = tuple((s, e, w) for s, e, w in product((0, 1), repeat=3))
"""In the order of the rows that a solver returns: row 4 s + 2 e + w."""
Bools = npt.NDArray[np.bool_]
ALL = -1
"""Asks a solver for every branch."""
Solver = Callable[[Array, Array, Array, Array, Array, int], tuple[Array, Bools]]
"""Takes axes and points `(6, 3)` and the wrist's centre `(3,)`, all at zero, rotations `(T, 3, 3)` and
translations `(T, 3)` of the last link from there, and the row of the one branch that is wanted, or `ALL`.
Returns joint positions `(T, 8, 6)` by branch, limits aside, and which of them exist `(T, 8)`."""
TOLERANCE = 1e-6
"""How far the point may be from an axis that is said to pass through it [m]."""


class InverseKinematics(ABC):
    """Inverse of a six-joint chain.

    Args:
        chain: the arm and its tool.
        lower: joint limits `(6,)` [rad].
        upper: joint limits `(6,)` [rad].
        wrist: indices of the joints whose axes meet in the wrist's centre.
        solver: the compiled solution of this kind of arm.

    Raises:
        PackError: the axes of the wrist do not meet.
    """

    def __init__(
        self, chain: SerialChain, lower: Array, upper: Array, wrist: Sequence[int], solver: Solver
    ) -> None:
        self.chain, self.lower, self.upper = chain, np.array(lower), np.array(upper)
        self._wrist, self._wrist_link, self._solver = meeting_point(chain, wrist), wrist[0], solver

    @abstractmethod
    def _slopes(self, z: Array, p: Array, w: Array) -> tuple[float, float]:
        """Derivatives whose signs tell elbow and flip.

        Args:
            z: joint axes as they are now `(6, 3)`.
            p: a point of each as it is now `(6, 3)`.
            w: the wrist's centre now `(3,)`.
        """

    def branch(self, q: Array) -> Branch:
        """The branch that joint positions belong to.

        Of both angles that `angles_to_plane` returns, the first is the one at which its component rises with
        the angle. So the branch is told by the signs of the components' derivatives by the joint's angle; the
        derivative of h . R(k, angle) a is h . (k x R a).
        """
        R, d = self.chain.links(q)
        z, p = screws.world_axes(self.chain.axes, self.chain.points, R, d)
        w = R[self._wrist_link] @ self._wrist + d[self._wrist_link]
        shoulder = (w - p[0]) @ np.cross(z[0], z[1])
        elbow, flip = self._slopes(z, p, w)
        return int(shoulder < 0.0), int(elbow < 0.0), int(flip < 0.0)

    def solve(self, X_WT: Pose) -> dict[Branch, Array]:
        """Joint positions `(6,)` in [-pi, pi) that bring the tool to a pose, limits aside, by branch."""
        rows, found = self._solutions(X_WT)
        return {branch: rows[i] for i, branch in enumerate(BRANCHES) if found[i]}

    def follow(self, X_WT: Pose, q_near: Array, branch: Branch) -> Array | None:
        """The solution of a branch, turned next to `q_near` `(6,)`; None without one in the limits."""
        rows = self.follow_rows(to_matrix(X_WT.q)[None], X_WT.p[None], q_near, branch)
        return rows[0] if len(rows) else None

    def follow_rows(self, R_WT: Array, p_WT: Array, q_near: Array, branch: Branch) -> Array:
        """The solutions of a branch for T poses of the tool, each turned next to the one before.

        Args:
            R_WT: orientations `(T, 3, 3)`.
            p_WT: positions `(T, 3)` [m].
            q_near: joint positions `(6,)` that the first solution is turned next to [rad].
            branch: the branch.

        Returns:
            Joint positions up to the first pose that has no solution in the limits: `(k, 6)`, k <= T.
        """
        row = 4 * branch[0] + 2 * branch[1] + branch[2]
        rows, found = self._rows(R_WT, p_WT, row)
        q = unwound_rows(rows[:, row], q_near)
        are_good = found[:, row] & np.all((q >= self.lower) & (q <= self.upper), axis=1)
        return q if are_good.all() else q[: int(np.argmin(are_good))]

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
        rows, found = self._rows(to_matrix(X_WT.q)[None], X_WT.p[None], ALL)
        return (rows[0] + np.pi) % TURN - np.pi, found[0]

    def _rows(self, R_WT: Array, p_WT: Array, only: int) -> tuple[Array, Bools]:
        # The tool moves with the last link: R_WT(q) = R R_WT(0) and p_WT(q) = R p_WT(0) + d.
        R = np.ascontiguousarray(R_WT @ self.chain.R_WT.T)
        d = np.ascontiguousarray(p_WT - R @ self.chain.p_WT)
        rows, found = self._solver(self.chain.axes, self.chain.points, self._wrist, R, d, only)
        return np.asarray(rows), np.asarray(found)


@numba.njit(cache=True)
def unwound_rows(rows: Array, q_near: Array) -> Array:
    """Joint positions `(T, n)` with whole turns that bring every joint within half a turn of the row before.

    So the arm does not unwind on its way; the first row is turned next to `q_near` `(n,)`.
    """
    q = np.empty(rows.shape)
    for t in range(len(rows)):
        for i in range(rows.shape[1]):
            near = q_near[i] if t == 0 else q[t - 1, i]
            q[t, i] = rows[t, i] + TURN * np.round((near - rows[t, i]) / TURN)
    return q


@numba.njit(cache=True)
def options(only: int, place: int) -> range:
    """Both solutions of a pair of angles, or the one of a branch's row, from its binary place 4, 2 or 1."""
    if only == ALL:
        return range(0, 2)  # noqa: PIE808 - numba tells ranges with one argument from those with two
    wanted = only // place % 2
    return range(wanted, wanted + 1)


@numba.njit(cache=True)
def shoulder_angles(z: Array, r: Array, w0: Array, w: Array) -> Array:
    """Both angles `(2,)` of joint 1 that let the wrist's centre come from `w0` at zero to `w`; else NaN.

    The joints up to the wrist but the first turn about axes along z[1], so they keep the component of the
    wrist's centre along it: (w - r[0]) . R1 z[1] = (w0 - r[0]) . z[1], subproblem 4.
    """
    return np.asarray(angles_to_plane(z[0], w - r[0], z[1], screws.dot(z[1], w0 - r[0])))


def meeting_point(chain: SerialChain, joints: Sequence[int]) -> Array:
    """The point `(3,)` that the axes of `joints` share where all joints are zero [m].

    Raises:
        PackError: they do not meet in one point.
    """
    # x is on axis i when (I - z z') (x - r) = 0: what is across the axis vanishes. Three rows for each axis.
    across = [np.eye(3) - np.outer(chain.axes[i], chain.axes[i]) for i in joints]
    A = np.vstack(across)
    b = np.concatenate([P @ chain.points[i] for P, i in zip(across, joints, strict=True)])
    point, _, rank, _ = np.linalg.lstsq(A, b, rcond=1e-9)
    if rank < 3 or np.abs(A @ point - b).max() > TOLERANCE:
        raise PackError(f"axes {[i + 1 for i in joints]} must meet in one point for this inverse")
    return np.asarray(point)
