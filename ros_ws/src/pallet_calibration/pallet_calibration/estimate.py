"""The least-squares estimate of where everything is, with its covariance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pack_core.palletizing.calibration import FitResiduals
from pack_core.rotations import Array
from pallet_calibration.measurements import BoardView, FeltContact
from pallet_calibration.model import CellModel, Sag, sag_at
from pallet_calibration.parameters import (
    prior_sigmas,
    start,
)
from pallet_calibration.procedure import Measurements

CORNER = 0.12
"""Standard deviation of a corner in a picture [pixel]."""
FEEL = 5e-5
"""Standard deviation of the place of a touch, beside that of its fit and of the joints [m]."""
GIVE = 0.20
"""Standard deviation of how far the arm gives, as a share: friction, and the parts of the force not felt."""
LOOSE = np.deg2rad(0.01) / np.sqrt(12.0)
"""Standard deviation of a joint anywhere in the play of its gear, by the data sheet 0.01 degrees [rad]."""
JOINTS = np.array([1.0, 0.3, 0.3, 1.0, 0.5, 1.0]) * LOOSE
"""Standard deviation of the links beyond what sag explains `(6,)`; the arm's weight takes up some play."""


@dataclass(frozen=True)
class CalibrationFit:
    """What was found.

    Attributes:
        x: the parameters, in the sequence of `model.PARAMETERS`.
        covariance: of them.
        views: residuals of the corners of each view, measured less predicted `(n, 2)` [pixel].
        contacts: residuals of the touches [m].
        gives: residuals of how far the arm gave, as shares.
        expected: standard deviation that each touch is known to have [m].
        view_errors: rms of each view's residuals once they are weighted by what is known of them.
    """

    x: Array
    covariance: Array
    views: tuple[Array, ...]
    contacts: Array
    gives: Array
    expected: Array
    view_errors: Array

    def residuals(self) -> tuple[FitResiduals, ...]:
        """A line for each kind of measurement."""
        share = self.contacts / self.expected
        return (
            _line("views of the board, weighted", self.view_errors, 1.0, "1"),
            _line("touches, weighted", share, 1.0, "1"),
            _line("touches", 1e3 * self.contacts, float(1e3 * np.sqrt(np.mean(self.expected**2))), "mm"),
            _line("give of the arm, share", self.gives, GIVE, "1"),
        )


def _line(name: str, values: Array, expected: float, unit: str) -> FitResiduals:
    rms, worst = float(np.sqrt(np.mean(values**2))), float(np.max(np.abs(values)))
    return FitResiduals(name=name, count=len(values), rms=rms, expected=expected, worst=worst, unit=unit)


def estimate(model: CellModel, measured: Measurements) -> CalibrationFit:
    """Fit all parameters to all measurements.

    Each view's corners share the error of the arm that holds the board. They are weighted by the covariance
    of both: corners are first fitted as if the arm were exact, which tells how they depend on its joints.
    """
    from scipy.optimize import least_squares  # half a second, which a node that never calibrates saves

    views, contacts = measured.views, measured.contacts
    held = [model.sag(view.q, loaded=True) for view in views]
    free = [sag_at(model, contact) for contact in contacts]
    expected = np.array([_touch_sigma(model, contact) for contact in contacts])

    def fitted(x: Array, whiteners: list[Array]) -> Any:
        def residuals(y: Array) -> Array:
            return _residuals(model, y, views, held, whiteners, contacts, free, expected)

        return least_squares(residuals, x, x_scale=prior_sigmas())

    first = fitted(start(), [np.eye(2 * len(view.ids)) / CORNER for view in views])
    whiteners = [_whitener(model, first.x, view, sag) for view, sag in zip(views, held, strict=True)]
    fit = fitted(first.x, whiteners)
    x = fit.x
    of_views = _view_residuals(model, x, views, held)
    weighted = [W @ r.ravel() for W, r in zip(whiteners, of_views, strict=True)]
    gaps = np.array([model.gap(x, c, s.links(x)) for c, s in zip(contacts, free, strict=True)])
    gives = np.array([model.give(x, c) / c.gives - 1.0 for c in contacts])
    return CalibrationFit(
        x, np.linalg.inv(fit.jac.T @ fit.jac), tuple(of_views), gaps, gives, expected,
        np.array([np.sqrt(np.mean(w**2)) for w in weighted]),
    )  # fmt: skip


def _residuals(
    model: CellModel, x: Array, views: Sequence[BoardView], held: Sequence[Sag], whiteners: Sequence[Array],
    contacts: Sequence[FeltContact], free: Sequence[Sag], expected: Array,
) -> Array:  # fmt: skip
    corners = [W @ r.ravel() for W, r in zip(whiteners, _view_residuals(model, x, views, held), strict=True)]
    gaps = [model.gap(x, c, sag.links(x)) for c, sag in zip(contacts, free, strict=True)]
    gives = [(model.give(x, c) / c.gives - 1.0) / GIVE for c in contacts]
    return np.concatenate([*corners, np.array(gaps) / expected, gives, (x - start()) / prior_sigmas()])


def _view_residuals(
    model: CellModel, x: Array, views: Sequence[BoardView], held: Sequence[Sag]
) -> list[Array]:
    links = [(view, sag.links(x)) for view, sag in zip(views, held, strict=True)]
    return [view.pixels - seen for view, seen in zip(views, model.pixels(x, links), strict=True)]


def _whitener(model: CellModel, x: Array, view: BoardView, sag: Sag) -> Array:
    """W with W^T W the inverse of the covariance of a view's corners, the noise of the joints included."""
    q = sag.links(x)
    J = _numeric(lambda joints: model.pixels(x, [(view, joints)])[0].ravel(), q)
    covariance = CORNER**2 * np.eye(2 * len(view.ids)) + (J * JOINTS**2) @ J.T
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))


def _touch_sigma(model: CellModel, contact: FeltContact) -> float:
    chain, normal = model.arm, contact.touch.normal
    slopes = normal @ chain.jacobian(contact.q)[:3]
    return float(np.sqrt(FEEL**2 + contact.sigma**2 + np.sum((slopes * JOINTS) ** 2)))


def _numeric(function: Callable[[Array], Array], x: Array, step: float = 1e-6) -> Array:
    """Central differences of a function, a column for each element of x."""
    columns = []
    for i in range(len(x)):
        d = np.zeros(len(x))
        d[i] = step
        columns.append((function(x + d) - function(x - d)) / (2.0 * step))
    return np.column_stack(columns)
