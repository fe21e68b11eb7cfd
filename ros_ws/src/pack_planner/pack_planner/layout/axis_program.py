"""The least displacement of all boxes along one axis, for a given order of the boxes along that axis."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

import daqp
import numpy as np

from pack_core.palletizing.orders.placed_box import TOUCH
from pack_core.rotations import Array

Relation = tuple[int, int]
"""A pair (i, j): box i comes before box j along the axis, with at least the gap between them."""

MM = 1e-3
"""A millimetre [m]."""
DAQP_INFINITY = 1e30
"""What DAQP takes for no bound."""
DAQP_OPTIMAL = 1
"""Its flag of a solution, in which no inequality is violated by more than 1e-6, here of a millimetre."""


@dataclass
class AxisProgram:
    """Minimises the boxes' displacements along one axis.

    A box's deviation is its displacement less the mean of those of the boxes it rests on, so that a stack
    moves as one. A deviation e costs e^2 / m with the free margin m towards the border in its direction: of
    two boxes that must part, each moves by its share of the free margin (Sec. 6.2 of the thesis).

    Attributes:
        lower: the boxes' lower bounds along the axis `(n,)` [m].
        upper: the boxes' upper bounds along the axis `(n,)` [m].
        follow: share of each box's carried base that lies on each other box `(n, n)`; zeros on the deck.
        length: length of the pallet along the axis [m].
        gap: free distance that neighbours must have [m].
        overhang: how far boxes may stand over the border [m], the virtual pallet margin.
        max_shift: no box is displaced further [m].
    """

    lower: Array
    upper: Array
    follow: Array
    length: float
    gap: float
    overhang: float
    max_shift: float
    _solved: dict[frozenset[Relation], tuple[Array, float] | None] = field(default_factory=dict)

    def solve(self, relations: Collection[Relation]) -> tuple[Array, float] | None:
        """Displacements `(n,)` [m] and their cost [m]; None where the relations cannot be fulfilled."""
        key = frozenset(relations)
        if key not in self._solved:
            self._solved[key] = self._solve(sorted(key))
        return self._solved[key]

    def _solve(self, relations: list[Relation]) -> tuple[Array, float] | None:
        n = len(self.lower)
        room = np.stack([self.length + self.overhang - self.upper, self.lower + self.overhang])
        weights = np.sqrt(np.where(room > TOUCH, room, 0.0))
        # The unknowns y >= 0 are the deviations e divided by sqrt(m): n of them up the axis, n down. Then the
        # cost is y^T y, and the displacements d follow from d = follow @ d + e, which is displaced @ y.
        displaced = np.linalg.solve(
            np.eye(n) - self.follow, np.hstack([np.diag(weights[0]), -np.diag(weights[1])])
        )
        first, second = (np.array([pair[k] for pair in relations], dtype=int) for k in (0, 1))
        reach = np.minimum(room, self.max_shift)
        # Rows of G y >= h: y >= 0; each box's reach up the axis, and down it; the gap of each relation.
        G = np.vstack([np.eye(2 * n), -displaced, displaced, displaced[second] - displaced[first]])
        h = np.concatenate(
            [np.zeros(2 * n), -reach[0], -reach[1], self.gap - self.lower[second] + self.upper[first]]
        )
        y = least_distance(G, h / MM)  # in millimetres, so that the numbers are of order 1
        return None if y is None else (displaced @ y * MM, float(y @ y) * MM**2)


def least_distance(G: Array, h: Array) -> Array | None:
    """The shortest x `(n,)` with G x >= h, G `(m, n)`; None where there is none.

    A least distance problem (Lawson and Hanson, "Solving Least Squares Problems", chapter 23), solved by the
    dual active set method of DAQP, which is exact up to rounding.
    """
    rows, n = G.shape
    no_upper_bound, inequalities = np.full(rows, DAQP_INFINITY), np.zeros(rows, dtype=np.int32)
    x, _, flag, _ = daqp.solve(np.eye(n), np.zeros(n), G, no_upper_bound, h, inequalities)
    return np.asarray(x) if flag == DAQP_OPTIMAL else None
