"""Contacts that should not be: the arm or its tool against anything, the carried box against its side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.palletizing.cell import BoxContact
from pack_core.robots.kr210 import ARM_BITS

STEEP = np.cos(np.deg2rad(45.0))
"""A contact whose normal is closer to the vertical than this supports a box."""
PAUSE = 0.1
"""A contact of the same bodies after a longer one is another one [s]."""


@dataclass(frozen=True)
class UnwantedContact:
    """Two bodies that touched though they should not.

    Attributes:
        time: when they began to [s].
        duration: [s].
        bodies: their names, sorted.
        force: largest of any contact point between them [N].
    """

    time: float
    duration: float
    bodies: tuple[str, str]
    force: float


class ContactWatch:
    """Collects unwanted contacts over a force.

    What supports the carried box from below is wanted, unless the box comes down on it faster than boxes
    are put down. What the arm touches is never wanted, and a side of the carried box neither.

    Args:
        contact: the force and the speed.
    """

    def __init__(self, contact: BoxContact) -> None:
        self._force, self._speed = contact.watch_force, contact.landing_speed
        self._kinds: npt.NDArray[np.bool_] = np.zeros(0, dtype=bool)
        self._known: dict[tuple[str, str], int] = {}
        self._handed_out = 0
        self.events: list[UnwantedContact] = []
        """Oldest first; the last one of every pair may go on."""

    def finished(self, time: float) -> list[UnwantedContact]:
        """Contacts that ended before `time` [s] and were not handed out yet, oldest first."""
        first = self._handed_out
        while self._handed_out < len(self.events) and self._end(self._handed_out) + PAUSE < time:
            self._handed_out += 1
        return self.events[first : self._handed_out]

    def index(self, model: mujoco.MjModel) -> None:
        """Take note of a new model."""
        self._kinds = (model.geom_contype & ARM_BITS) != 0

    def update(self, model: mujoco.MjModel, data: mujoco.MjData, held: str) -> None:
        """Look at the contacts of the last step.

        Args:
            model: that was indexed.
            data: after the step.
            held: name of the carried box, empty when none.
        """
        if data.ncon == 0:
            return
        pairs = data.contact.geom
        suspects = self._kinds[pairs].any(axis=1)
        if held:
            geom = model.geom(held).id
            suspects |= (pairs == geom).any(axis=1) & ~self._supports(model, data, held)
        for i in np.flatnonzero(suspects):
            self._note(model, data, int(i))

    def _supports(self, model: mujoco.MjModel, data: mujoco.MjData, held: str) -> npt.NDArray[np.bool_]:
        """Which contacts `(ncon,)` the carried box may rest on."""
        dof = model.body(held).dofadr[0]
        is_slow = np.linalg.norm(data.qvel[dof : dof + 3]) <= self._speed
        upright: npt.NDArray[np.bool_] = np.abs(data.contact.frame[:, 2]) > STEEP
        return upright & is_slow

    def _note(self, model: mujoco.MjModel, data: mujoco.MjData, i: int) -> None:
        wrench = np.zeros(6)
        mujoco.mj_contactForce(model, data, i, wrench)
        force = float(np.linalg.norm(wrench[:3]))
        if force <= self._force:
            return
        a, b = sorted(model.body(model.geom_bodyid[g]).name for g in data.contact.geom[i])
        time, last = float(data.time), self._known.get((a, b))
        if last is not None and time <= self._end(last) + PAUSE:
            event = self.events[last]
            self.events[last] = replace(event, duration=time - event.time, force=max(force, event.force))
        else:
            self._known[a, b] = len(self.events)
            self.events.append(UnwantedContact(time, 0.0, (a, b), force))

    def _end(self, index: int) -> float:
        return self.events[index].time + self.events[index].duration
