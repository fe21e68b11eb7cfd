"""The packing cost: weighted norms of residuals over the horizon (Eq. 2) and its expansion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_mpc.cost.norms import QUADRATIC
from pack_mpc.cost.residuals import RESIDUALS, ResidualOptions
from pack_mpc.cost.weights import StageWeights, Weights
from pack_mpc.plant import Linearization, PackingPlant
from pack_mpc.target import PackingTarget


class Residuals:
    """The residual vector r(x, y) with R rows: those of every class in `RESIDUALS`, one after the other.

    Each is the root of its norm, so that its squares are what Eq. 2 weighs: |r_i|^2 = n_i(residual i).

    Args:
        plant: the model that states and outputs are of.
        options: how some residuals are written, and the norms.
        target: where the held object shall go.
    """

    def __init__(self, plant: PackingPlant, options: ResidualOptions, target: PackingTarget) -> None:
        self._terms = [
            (term(plant, target, options), options.norms.get(term.name, QUADRATIC)) for term in RESIDUALS
        ]

    def values(self, xs: Array, ys: Array) -> Array:
        """Residuals `(..., R)` of states `(..., nx)` and outputs `(..., ny)`."""
        return np.concatenate([norm.root(term.values(xs, ys)) for term, norm in self._terms], axis=-1)

    def jacobians(self, xs: Array, ys: Array, lin: Linearization, columns: np.ndarray) -> tuple[Array, Array]:
        """dr/dx `(T+1, R, n)` over the n state components `columns`, and dr/du `(T, R, m)`."""
        parts = []
        for term, norm in self._terms:
            r = term.values(xs, ys)
            jx, ju = term.jacobians(xs, ys, lin, columns)
            # The last state has no control, so dr/du has one step less.
            parts.append((norm.chain(r, jx), norm.chain(r[:-1], ju)))
        jx, ju = (np.concatenate(matrices, axis=1) for matrices in zip(*parts, strict=True))
        return jx, ju

    def spread(self, weights: Weights) -> Array:
        """The weights as one vector `(R,)`: a single number holds for every row of its residual."""
        return np.concatenate([np.broadcast_to(weights[term.name], term.rows) for term, _ in self._terms])


@dataclass(frozen=True)
class Expansion:
    """Quadratic model of the cost l at every step: its first and second derivatives by state and control.

    `lx (T+1,n)`, `lxx (T+1,n,n)`, `lu (T,m)`, `luu (T,m,m)`, `lux (T,m,n)`; the last state has no control.
    """

    lx: Array
    lxx: Array
    lu: Array
    luu: Array
    lux: Array


class PackingCost:
    """Sum over the horizon of w r^2 and of squared torque: Eq. 2, the residuals r being roots of norms.

    Args:
        residuals: the residual vector r(x, y), whose squares are the norms.
        weights: weights in force, of the steps before the last and of the last.
        torque: weight of squared torque.
    """

    def __init__(self, residuals: Residuals, weights: StageWeights, torque: float) -> None:
        self._residuals = residuals
        self._running = residuals.spread(weights.running)
        self._terminal = residuals.spread(weights.terminal)
        self._torque = torque

    def value(self, xs: Array, ys: Array, us: Array) -> Array:
        """Costs `(B,)` of trajectories `xs (B,T+1,nx)`, `ys (B,T+1,ny)`, `us (B,T,7)`."""
        return np.asarray((self.weighted(xs, ys) ** 2).sum(axis=1) + self._torque * (us**2).sum(axis=(1, 2)))

    def weighted(self, xs: Array, ys: Array) -> Array:
        """Residuals of a batch times the roots of their weights, as one row a trajectory `(B, M)`.

        The sum of their squares is the cost, which makes them the residuals of a Gauss-Newton step.
        """
        r = self._residuals.values(xs, ys)
        r[:, :-1] *= np.sqrt(self._running)
        r[:, -1] *= np.sqrt(self._terminal)
        return r.reshape(len(r), -1)

    def expand(self, xs: Array, ys: Array, us: Array, lin: Linearization, columns: np.ndarray) -> Expansion:
        """Quadratic model along one trajectory: with l = w r^2 and J = dr/dx, lx = 2 w r J, lxx = 2 w J' J.

        Gauss-Newton leaves out the second derivatives of r, so lxx is never indefinite.
        """
        r = self._residuals.values(xs, ys)
        jx, ju = self._residuals.jacobians(xs, ys, lin, columns)
        w = np.concatenate([np.tile(self._running, (len(us), 1)), self._terminal[None]])
        wjx, wju = 2.0 * w[..., None] * jx, 2.0 * w[:-1, :, None] * ju
        m = us.shape[1]
        return Expansion(
            lx=(r[:, None] @ wjx)[:, 0],
            lxx=jx.swapaxes(1, 2) @ wjx,
            lu=(r[:-1, None] @ wju)[:, 0] + 2.0 * self._torque * us,
            luu=ju.swapaxes(1, 2) @ wju + 2.0 * self._torque * np.eye(m),
            lux=ju.swapaxes(1, 2) @ wjx[:-1],
        )
