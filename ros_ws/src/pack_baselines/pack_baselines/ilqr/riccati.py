"""The recursions of iLQR over the horizon.

They are hundreds of products of small matrices, too many calls for NumPy: compiled at the first import.
"""

from __future__ import annotations

import numba
import numpy as np

from pack_core.rotations import Array


@numba.njit(cache=True)
def _factorise(L: Array) -> bool:
    """Replace a symmetric `(m, m)` by its Cholesky factor; return False if it is not positive definite."""
    m = len(L)
    for j in range(m):
        pivot = L[j, j] - np.sum(L[j, :j] ** 2)
        if not pivot > 0.0:
            return False
        L[j, j] = np.sqrt(pivot)
        for i in range(j + 1, m):
            L[i, j] = (L[i, j] - np.sum(L[i, :j] * L[j, :j])) / L[j, j]
    return True


@numba.njit(cache=True)
def _solve(L: Array, B: Array) -> None:
    """Replace `B (m, p)` by the solution X of L L' X = B."""
    m = len(L)
    for i in range(m):  # forwards: L Y = B
        for j in range(i):
            B[i] -= L[i, j] * B[j]
        B[i] /= L[i, i]
    for i in range(m - 1, -1, -1):  # backwards: L' X = Y
        for j in range(i + 1, m):
            B[i] -= L[j, i] * B[j]
        B[i] /= L[i, i]


@numba.njit(
    "Tuple((b1, f8[:, ::1], f8[:, :, ::1]))"
    "(f8[:, :, ::1], f8[:, ::1], f8[:, :, ::1], f8[::1], f8[:, ::1], f8)",
    cache=True,
)
def backward_pass(
    F: Array, q: Array, Q: Array, vx: Array, vxx: Array, regularisation: float
) -> tuple[bool, Array, Array]:
    """Riccati recursion of a time-varying LQR problem over z = (x, u), with n states and m controls.

    The value of a state is V(x) = min over u of l(x, u) + V(f(x, u)); from the last step on backwards,
    with V's derivatives vx, vxx: Q_z = l_z + F' vx, Q_zz = l_zz + F' vxx F, and the minimum over u is at
    du = -Quu^-1 (Qu + Qux dx).

    Args:
        F: dynamics dx_{t+1} = F dz_t `(T, n, n+m)`.
        q: gradient of the cost by z `(T, n+m)`.
        Q: Hessian of the cost by z `(T, n+m, n+m)`.
        vx: gradient `(n,)` of the last state's cost.
        vxx: Hessian `(n, n)` of the last state's cost.
        regularisation: added to the diagonal of Quu.

    Returns:
        Whether every Quu was positive definite, and the gains `k (T,m)` and `K (T,m,n)` of du = k + K dx.
    """
    steps, n = F.shape[0], F.shape[1]
    m = F.shape[2] - n
    k, K = np.empty((steps, m)), np.empty((steps, m, n))
    for t in range(steps - 1, -1, -1):
        qt = q[t] + F[t].T @ vx
        Qt = Q[t] + F[t].T @ (vxx @ F[t])
        quu, qux = np.ascontiguousarray(Qt[n:, n:]), np.ascontiguousarray(Qt[n:, :n])
        L = quu + regularisation * np.eye(m)
        if not _factorise(L):
            return False, k, K
        gains = np.empty((m, n + 1))
        gains[:, 0], gains[:, 1:] = qt[n:], qux
        _solve(L, gains)
        k[t], K[t] = -gains[:, 0], -gains[:, 1:]
        # Not the short forms, which hold for the exact minimum only: with regularisation, du is short of it.
        vx = qt[:n] + K[t].T @ (quu @ k[t] + qt[n:]) + qux.T @ k[t]
        vxx = Qt[:n, :n] + K[t].T @ (quu @ K[t] + qux) + qux.T @ K[t]
        vxx = 0.5 * (vxx + vxx.T)  # rounding would make it ever less symmetric
    return True, k, K


@numba.njit("f8[:, ::1](f8[:, :, ::1], f8[:, :, ::1], f8[:, ::1], f8[:, :, ::1])", cache=True)
def forward_pass(A: Array, B: Array, k: Array, K: Array) -> Array:
    """Change of the controls `(T, m)` for a full step of the gains, along dx' = A dx + B du."""
    dx = np.zeros(A.shape[1])
    du = np.empty_like(k)
    for t in range(len(k)):
        du[t] = k[t] + K[t] @ dx
        dx = A[t] @ dx + B[t] @ du[t]
    return du
