"""What the hand holds, weighed by the arm's own torques while it lifts.

The torque of each joint is what the bare arm takes, the friction of the joint, and the share of the load:

    tau = ID(q, v, a) + f sign(v) + m y(q, v, a)

where ID is the inverse dynamics of the arm with an empty hand, and y what a load of 1 kg adds, which is known
from where the box hangs and how large it is. The friction f is measured whenever the arm moves with an empty
hand, so that what is weighed is the difference, as with a scale that is set to zero first.
"""

from __future__ import annotations

from collections import deque

import mujoco
import numpy as np

from pack_core.joints import JointSample
from pack_core.palletizing.arm_dynamics import CarriedLoad
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.kr210 import FRICTION, LIMITS
from pack_core.rotations import Array, Pose

STEP = 0.015
"""Least time between two samples that are used [s]: accelerations are differences of their speeds."""
GAP = 0.03
"""Samples that are farther apart are no neighbours [s]: an arm that brakes for late setpoints and goes on
accelerates by nothing on average, but its torques are those of the brake."""
MOVING = 0.01
"""A joint that is slower may stand, and friction that holds it has any value [rad/s]."""
STEADY = 0.15
"""Nothing is weighed while a joint accelerates more from one sample to the next [rad/s^2]: gears wind up, and
motors lead the links. An arm that a person slows down goes by jerks that may cancel out over two samples."""
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
        self._samples: deque[JointSample] = deque(maxlen=3)
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
        """Take note of the joints; samples that are nearer than `STEP` to the last one are left out."""
        samples = self._samples
        if samples and not STEP <= sample.time - samples[-1].time <= GAP:
            if sample.time > samples[-1].time + GAP or sample.time < samples[-1].time:
                samples.clear()
            else:
                return
        samples.append(sample)
        if len(samples) == samples.maxlen:
            self._use(*samples)

    def _begin(self, *, is_loaded: bool) -> None:
        self._is_loaded = is_loaded
        self._product = self._square = self.seconds = 0.0
        self._samples.clear()

    def _use(self, before: JointSample, now: JointSample, after: JointSample) -> None:
        halves = [(b.v - a.v) / (b.time - a.time) for a, b in ((before, now), (now, after))]
        a = (after.v - before.v) / (after.time - before.time)
        direction = np.where(np.abs(now.v) > MOVING, np.sign(now.v), 0.0)
        if not direction.any():
            return
        bare = _torques(self._bare.model, self._bare_data, now, a)
        excess = now.tau - bare
        if not self._is_loaded:
            keep = np.where(direction != 0.0, 0.5 ** (1.0 / TARE), 1.0)
            self._rubbed = keep * self._rubbed + direction * excess
            self._counts = keep * self._counts + np.abs(direction)
            return
        if np.abs(halves).max() > STEADY:
            return
        self.seconds += 0.5 * (after.time - before.time)
        # Least squares over all joints that move, each with the noise of its motor: a share of its effort.
        per_kg = _torques(self._loaded.model, self._loaded_data, now, a) - bare
        weights = np.abs(direction) / LIMITS.effort**2
        self._product += float(weights @ (per_kg * (excess - direction * self.friction)))
        self._square += float(weights @ per_kg**2)


def _torques(model: mujoco.MjModel, data: mujoco.MjData, sample: JointSample, a: Array) -> Array:
    """Inverse dynamics of the joints with accelerations `(6,)` [rad/s^2]: torques `(6,)` [N m]."""
    data.qpos[:], data.qvel[:], data.qacc[:] = sample.q, sample.v, a
    mujoco.mj_inverse(model, data)
    return np.array(data.qfrc_inverse)
