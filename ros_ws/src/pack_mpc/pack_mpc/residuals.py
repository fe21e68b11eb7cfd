"""All residuals as one vector, with their norms, their derivatives and their weights."""

from __future__ import annotations

import numpy as np

from pack_core.rotations import Array
from pack_mpc.ilqr import Linearization
from pack_mpc.norms import QUADRATIC
from pack_mpc.plant import PackingPlant
from pack_mpc.residual_base import ResidualOptions
from pack_mpc.residual_terms import RESIDUALS
from pack_mpc.target import PackingTarget
from pack_mpc.weights import Weights


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
