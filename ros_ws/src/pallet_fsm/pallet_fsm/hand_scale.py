"""What the hand holds, weighed by the arm's own torques while it lifts.

The torque of each joint is what the bare arm takes, the friction of the joint, and the share of the load:

    tau = ID(q, v, a) + f sign(v) + m y(q, v, a)

where ID is the inverse dynamics of the arm with an empty hand, and y what a load of 1 kg adds, which is known
from where the box hangs and how large it is. The friction f is measured whenever the arm moves at an even
speed with an empty hand: what is weighed is the difference, as with a scale that is set to zero first.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from pack_core.joints import JointSample
from pack_core.palletizing.arm_dynamics import CarriedLoad
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.kr210 import FRICTION, LIMITS
from pack_core.rotations import Array, Pose

STEP = 0.015
"""Least time from a sample that is used to those whose speeds give its acceleration, before and after [s]."""
GAP = 0.03
"""Samples that are farther apart are no neighbours [s]: an arm that brakes for late setpoints and goes on
accelerates by nothing on average, but its torques are those of the brake."""
MOVING = 0.01
"""A joint that is slower may stand, and friction that holds it has any value [rad/s]."""
STEADY = 0.15
"""Nothing is measured while a joint accelerates more [rad/s^2]: gears wind up, and motors lead the links."""
TARE = 200
"""Samples after which what was measured with an empty hand counts half as much: about 4 s of motion."""
PRIOR = 20.0
"""Samples as many as which the published friction counts at the start."""


class HandScale:
    """Weighs what the hand holds, from the joints as measured.

    Args:
        cell: the cell's physical facts.

    Attributes:
        seconds: time over which the present load was weighed [s].
    """

    def __init__(self, cell: PalletizingCell) -> None:
        self._bare, self._loaded = CarriedLoad(cell), CarriedLoad(cell)
        self._bare_data = mujoco.MjData(self._bare.model)
        self._loaded_data = mujoco.MjData(self._loaded.model)
        self._samples: list[JointSample] = []
        self._rubbed = PRIOR * FRICTION * LIMITS.effort
        self._counts = np.full(6, PRIOR)
        self._is_loaded = False
        self._product = self._square = 0.0
        self.seconds = 0.0

    @property
    def friction(self) -> Array:
        """Friction of the joints `(6,)` [N m], as measured so far."""
        return np.asarray(self._rubbed / self._counts)

    @property
    def mass(self) -> float | None:
        """Of the load [kg]; None before it has moved, and while the hand is empty."""
        return self._product / self._square if self._is_loaded and self._square > 0.0 else None

    def put_on(self, dims: Array, X_TB: Pose) -> None:
        """Weigh a box from now on: edges `(3,)` [m], held at X_TB."""
        self._loaded.put_on(BoxBody("load", tuple(dims), 1.0), X_TB)
        self._begin(is_loaded=True)

    def take_off(self) -> None:
        """The hand is empty from now on."""
        self._begin(is_loaded=False)

    def note(self, sample: JointSample) -> None:
        """Take note of the joints; one sample in each `STEP` is used, and its neighbours for how it moves."""
        samples = self._samples
        if samples and sample.time == samples[-1].time:
            return
        if samples and not 0.0 < sample.time - samples[-1].time <= GAP:
            samples.clear()
        samples.append(sample)
        if sample.time - samples[0].time >= 2.0 * STEP:
            middle = next(i for i, one in enumerate(samples) if one.time - samples[0].time >= STEP)
            self._use(samples, samples[middle])
            del samples[:middle]

    def _begin(self, *, is_loaded: bool) -> None:
        self._is_loaded = is_loaded
        self._product = self._square = self.seconds = 0.0
        self._samples.clear()

    def _use(self, samples: Sequence[JointSample], now: JointSample) -> None:
        """Use one of some samples that follow each other."""
        before, after = samples[0], samples[-1]
        a = (after.v - before.v) / (after.time - before.time)
        direction = np.where(np.abs(now.v) > MOVING, np.sign(now.v), 0.0)
        if not direction.any():
            return
        if not all(_is_steady(sample, now) for sample in samples):
            return
        bare = _torques(self._bare.model, self._bare_data, now, a)
        excess = now.tau - bare
        if not self._is_loaded:
            keep = np.where(direction != 0.0, 0.5 ** (1.0 / TARE), 1.0)
            self._rubbed = keep * self._rubbed + direction * excess
            self._counts = keep * self._counts + np.abs(direction)
            return
        self.seconds += 0.5 * (after.time - before.time)
        # Least squares over all joints that move, each with the noise of its motor: a share of its effort.
        per_kg = _torques(self._loaded.model, self._loaded_data, now, a) - bare
        weights = np.abs(direction) / LIMITS.effort**2
        self._product += float(weights @ (per_kg * (excess - direction * self.friction)))
        self._square += float(weights @ per_kg**2)


def _is_steady(sample: JointSample, other: JointSample) -> bool:
    """Whether no joint has accelerated by more than `STEADY` from one sample to the other.

    An arm that a person slows down goes by jerks that cancel out over some samples, but not over all.
    """
    return bool(np.abs(sample.v - other.v).max() <= STEADY * abs(sample.time - other.time))


def _torques(model: mujoco.MjModel, data: mujoco.MjData, sample: JointSample, a: Array) -> Array:
    """Inverse dynamics of the joints with accelerations `(6,)` [rad/s^2]: torques `(6,)` [N m]."""
    data.qpos[:], data.qvel[:], data.qacc[:] = sample.q, sample.v, a
    mujoco.mj_inverse(model, data)
    return np.array(data.qfrc_inverse)
