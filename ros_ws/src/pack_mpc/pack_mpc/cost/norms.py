"""The norms n_i of Eq. 2: what a residual costs, given how large it is.

The optimizers minimise a sum of squares. A norm therefore states its root: a residual r' with |r'|^2 = n(r),
smooth wherever n is. Gauss-Newton on r' is Gauss-Newton on the cost, for SGN, which takes differences of r',
and for iLQR, which takes dr'/dx = dr'/dr dr/dx.

The paper asks that n_i be twice differentiable, and says no more. The norms here, but for a factor of 2, are
those of MuJoCo MPC (Howell et al., "Predictive sampling: Real-time behaviour synthesis with MuJoCo", 2022),
which Eq. 2 is taken from.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array

FLOOR = 1e-9
"""Constant cost that keeps the root of `Linear` differentiable at r = 0."""


class Norm(Config, ABC):
    """A norm n of residual vectors r `(..., R)`."""

    @abstractmethod
    def root(self, r: Array) -> Array:
        """The residual r' `(..., R)` with |r'|^2 = n(r)."""

    @abstractmethod
    def chain(self, r: Array, jacobian: Array) -> Array:
        """dr'/dx `(..., R, n)` from r `(..., R)` and dr/dx `(..., R, n)`."""


class Quadratic(Norm):
    """n(r) = |r|^2."""

    norm: Literal["quadratic"] = "quadratic"

    def root(self, r: Array) -> Array:
        return r

    def chain(self, r: Array, jacobian: Array) -> Array:
        return jacobian


class RowNorm(Norm):
    """A norm that is a sum over the rows, n(r) = sum_i n(r_i)."""

    @abstractmethod
    def slope(self, r: Array) -> Array:
        """dr'_i/dr_i `(..., R)`."""

    def chain(self, r: Array, jacobian: Array) -> Array:
        return self.slope(r)[..., None] * jacobian


class Linear(RowNorm):
    """n(r) = sum_i r_i, for residuals that are never negative: those written as a cost already."""

    norm: Literal["linear"]

    def root(self, r: Array) -> Array:
        return np.sqrt(r + FLOOR)

    def slope(self, r: Array) -> Array:
        return np.asarray(0.5 / np.sqrt(r + FLOOR))


class SmoothAbs(RowNorm):
    """n(r) = sum_i sqrt(r_i^2 + p^2) - p: quadratic below p, the absolute value above it.

    Attributes:
        p: size of a residual up to which it counts as small, in the residual's unit.
    """

    norm: Literal["smooth_abs"]
    p: PositiveFloat

    def root(self, r: Array) -> Array:
        # sqrt(r^2 + p^2) - p = r^2 / (sqrt(r^2 + p^2) + p), whose root is smooth and has the sign of r
        return np.asarray(r / np.sqrt(np.hypot(r, self.p) + self.p))

    def slope(self, r: Array) -> Array:
        s = np.hypot(r, self.p)
        return np.asarray(np.sqrt(s + self.p) / (2.0 * s))


class L2(Norm):
    """n(r) = sqrt(|r|^2 + p^2) - p: the length of the whole vector, rounded off below p.

    Rows with different weights share the length in proportion to their squares.

    Attributes:
        p: length up to which the vector counts as short, in the residual's unit.
    """

    norm: Literal["l2"]
    p: PositiveFloat

    def root(self, r: Array) -> Array:
        return np.asarray(r / np.sqrt(self._length(r) + self.p))

    def chain(self, r: Array, jacobian: Array) -> Array:
        # r' = r d^-1/2 with d = s + p, s = sqrt(|r|^2 + p^2) and ds = r . dr / s
        s = self._length(r)[..., None]
        d = s + self.p
        along = r[..., None] * (r[..., None, :] @ jacobian)
        return np.asarray(jacobian / np.sqrt(d) - along / (2.0 * s * d**1.5))

    def _length(self, r: Array) -> Array:
        return np.asarray(np.sqrt((r**2).sum(axis=-1, keepdims=True) + self.p**2))


class Cosh(RowNorm):
    """n(r) = sum_i p^2 (cosh(r_i / p) - 1): quadratic below p, steeper and steeper above it.

    Attributes:
        p: size of a residual above which it counts as large, in the residual's unit.
    """

    norm: Literal["cosh"]
    p: PositiveFloat

    def root(self, r: Array) -> Array:
        # cosh(x) - 1 = 2 sinh(x / 2)^2
        return np.asarray(np.sqrt(2.0) * self.p * np.sinh(0.5 * r / self.p))

    def slope(self, r: Array) -> Array:
        return np.asarray(np.cosh(0.5 * r / self.p) / np.sqrt(2.0))


AnyNorm = Annotated[Quadratic | Linear | SmoothAbs | L2 | Cosh, Field(discriminator="norm")]
"""Every norm that a weights file can name. A new one is added here."""
QUADRATIC = Quadratic()
