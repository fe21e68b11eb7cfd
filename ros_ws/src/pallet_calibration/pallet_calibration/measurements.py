"""What a calibration measures, as plain numbers: touches, and views of the board."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.kinematics.chain import SerialChain
from pack_core.rotations import Array, Pose
from pallet_calibration.rig import CalibrationFailed
from pallet_calibration.touch import SLOW, Touch, push_vector

SETTLED = 30
"""Samples of a slow approach that are left out at its start."""
RISE = 0.0008
"""Stretch before the end of a touch that is not taken for free motion [m]."""
FELT = 50.0
"""Force from which on a touch shows how far the gears give [N]."""


@dataclass(frozen=True)
class BoardView:
    """The board in one picture: reported joints `q` `(6,)`, numbers and pixels `(n, 2)` of its corners."""

    q: Array
    ids: Array
    pixels: Array


@dataclass(frozen=True)
class FeltContact:
    """The moment of a touch.

    Attributes:
        touch: the touch.
        q: reported joints at that moment `(6,)`.
        sigma: standard deviation of the place by the fit [m].
        gives: by how much the reported tool goes on along the approach while it presses [m]: the mean over
            the samples, weighted by force.
        bears: the same for the unit compliance of each joint `(6,)` [m N m/rad].
        way: of each sample, from the moment of the touch along the approach `(n,)` [m].
        felt: force along the approach at each sample `(n,)` [N].
    """

    touch: Touch
    q: Array
    sigma: float
    gives: float
    bears: Array
    way: Array
    felt: Array

    @property
    def name(self) -> str:
        """What was touched, and along which axis."""
        return f"{self.touch.what}, {'xyz'[self.touch.axis]}"


def contact_of(touch: Touch, arm: SerialChain, period: float) -> FeltContact:
    """When a surface was touched, and how far the arm gives while it presses.

    The force is fitted by f = max(0, k (s - s_0)) over the way s along the approach. Before the contact the
    torques drift evenly, by weight and friction; the drift is fitted and subtracted.

    Raises:
        CalibrationFailed: the force does not rise as from a surface.
    """
    chain = arm.with_tool(Pose(touch.p_TC))
    way = np.array([chain.forward_matrix(q)[1] for q in touch.q]) @ touch.normal
    free = int(np.argmax(way > way[-1] - RISE))
    if free < 2 * SETTLED:
        raise CalibrationFailed(f"{touch.what}: touched before the arm moved evenly")
    steps = np.rint((touch.times - touch.times[0]) / period)  # a sample that was lost leaves a gap
    line = np.polyfit(steps[SETTLED:free], touch.tau[SETTLED:free], 1)
    change = touch.tau - np.outer(steps, line[0]) - line[1]
    rate = (touch.q[free] - touch.q[SETTLED]) / (period * SLOW * (steps[free] - steps[SETTLED]))
    J = np.array([chain.jacobian(q)[:3] for q in touch.q])
    forces = np.array([push_vector(J_i, c, rate) for J_i, c in zip(J, change, strict=True)])
    felt = forces @ touch.normal
    s_0, sigma = _onset(way[free:], felt[free:], float(np.std(felt[SETTLED:free])))
    at = int(np.argmax(way >= s_0))
    share = (s_0 - way[at - 1]) / max(way[at] - way[at - 1], 1e-9)
    q = touch.q[at - 1] + np.clip(share, 0.0, 1.0) * (touch.q[at] - touch.q[at - 1])
    pressing = np.flatnonzero(felt > FELT)
    pressing = pressing[pressing > at]
    if len(pressing) < 10:
        raise CalibrationFailed(f"{touch.what}: no force was felt beyond the place of the contact")
    weights = felt[pressing] / felt[pressing].sum()
    gives = float(weights @ (way[pressing] - s_0))
    slopes = np.einsum("j,kji->ki", touch.normal, J[pressing])
    bears = weights @ (slopes * np.einsum("kji,kj->ki", J[pressing], forces[pressing]))
    return FeltContact(touch, q, sigma, gives, bears, way - s_0, felt)


def _onset(way: Array, felt: Array, noise: float) -> tuple[float, float]:
    """Where the force begins to rise [m], and its standard deviation."""
    best, found = np.inf, (0.0, 0.0)
    # The best slope has a closed form for each place, so places are simply tried, every 2 um.
    for s_0 in np.arange(way[0], way[-1], 2e-6):
        rise = np.maximum(0.0, way - s_0)
        if not rise.any():
            break
        slope = max(float(rise @ felt) / float(rise @ rise), 0.0)
        cost = float(np.sum((felt - slope * rise) ** 2))
        if cost < best:
            best, found = cost, (float(s_0), slope)
    s_0, slope = found
    if slope <= 0.0:
        raise CalibrationFailed("no force was felt")
    pressing = max(int(np.count_nonzero(way > s_0)), 1)
    return s_0, float(2.0 * noise / (slope * np.sqrt(pressing)))
