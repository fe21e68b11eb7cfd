"""Keeps setpoints ahead of the measurements, so that the driver never runs out of them."""

from __future__ import annotations

from collections import deque

import numpy as np

from pack_core.joint_reference import JointReference
from pack_core.motion.target import JointSetpoint
from pack_core.scene.state import JointSample
from pack_motion.controller import MotionController

MEMORY = 256


class SetpointStream:
    """Steps a controller to a horizon beyond each measurement.

    Args:
        controller: freshly started.
        period: between setpoints [s].
        horizon: how far they reach beyond the newest measurement [s].
    """

    def __init__(self, controller: MotionController, period: float, horizon: float) -> None:
        self.controller = controller
        self._period, self._horizon = period, horizon
        self._rows: deque[JointSetpoint] = deque(maxlen=MEMORY)
        state = controller.commanded
        self._rows.append(JointSetpoint(controller.time, state.q, state.v, state.a))

    def is_interrupted(self, sample: JointSample) -> bool:
        """Whether time went back, or the measurements jumped beyond all setpoints."""
        newest = self._rows[-1].time
        return sample.time > newest + self._horizon or sample.time < newest - 2.0 * self._horizon

    def advance(self, sample: JointSample) -> JointReference:
        """Setpoints from the last that has come to the horizon."""
        while self.controller.time + self._period <= sample.time + self._horizon + 1e-9:
            self._rows.append(self.controller.step(self.controller.time + self._period, sample))
        while len(self._rows) > 1 and self._rows[1].time <= sample.time:
            self._rows.popleft()
        times = np.array([row.time for row in self._rows])
        q, v, a = (np.array([getattr(row, name) for row in self._rows]) for name in ("q", "v", "a"))
        return JointReference(float(times[0]), times - times[0], q, v, a)
