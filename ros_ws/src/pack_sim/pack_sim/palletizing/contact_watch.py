"""What whoever looks on is told: unwanted contacts, and how near visitors truly came to the arm.

Unwanted are contacts of the arm or its tool with anything, and of a side of the carried box with anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.palletizing.cell import BoxContact
from pack_core.robots.kr210 import ARM_BITS

STEEP = np.cos(np.deg2rad(45.0))
"""Cosine of 45 degrees: a contact whose normal is nearer to the vertical than that supports a box."""
PAUSE = 0.1
"""Contacts of the same two bodies with a longer pause between them count as two events [s]."""


@dataclass(frozen=True)
class UnwantedContact:
    """Two bodies that touched though they should not.

    Attributes:
        time: when the contact began [s].
        duration: how long it lasted [s].
        bodies: names of the two bodies, sorted.
        force: largest force at any contact point between them [N].
    """

    time: float
    duration: float
    bodies: tuple[str, str]
    force: float


class ContactWatch:
    """Collects unwanted contacts whose force is above a limit.

    A contact that supports the carried box from below is wanted, unless the box comes down faster than boxes
    are put down. Contacts of the arm and of a side of the carried box are always unwanted.

    Args:
        contact: the force above which contacts are recorded, and the largest landing speed.
    """

    def __init__(self, contact: BoxContact) -> None:
        self._force, self._speed = contact.watch_force, contact.landing_speed
        self._kinds: npt.NDArray[np.bool_] = np.zeros(0, dtype=bool)
        self._known: dict[tuple[str, str], int] = {}
        self._handed_out = 0
        self.events: list[UnwantedContact] = []
        """All events, oldest first; the last one of each pair of bodies may still go on."""

    def finished(self, time: float) -> list[UnwantedContact]:
        """Contacts that ended before `time` [s] and were not handed out yet, oldest first."""
        first = self._handed_out
        while self._handed_out < len(self.events) and self._end(self._handed_out) + PAUSE < time:
            self._handed_out += 1
        return self.events[first : self._handed_out]

    def index(self, model: mujoco.MjModel) -> None:
        """Find the arm's geoms in a new model; to be called whenever the model was built anew."""
        self._kinds = (model.geom_contype & ARM_BITS) != 0

    def update(self, model: mujoco.MjModel, data: mujoco.MjData, held: str) -> None:
        """Look at the contacts of the last step.

        Args:
            model: the model that was indexed last.
            data: the state after the step.
            held: name of the carried box; empty when none is carried.
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
        """For each contact `(ncon,)`, whether it is one that may support the carried box."""
        dof = model.body(held).dofadr[0]  # of a free joint: first the linear velocity, in the world
        is_slow = np.linalg.norm(data.qvel[dof : dof + 3]) <= self._speed
        # The first three entries of a contact frame are its normal in the world: entry 2 is its z coordinate.
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


FARTHEST = 5.0
"""Distances are computed up to this [m]; beyond it, this is the result."""


def visitor_distances(
    model: mujoco.MjModel, data: mujoco.MjData, visitors: Sequence[str], held: str
) -> dict[str, float]:
    """Least distance [m] of each visitor from the moving parts of the arm; negative where they overlap.

    Args:
        model: the cell.
        data: its state, with body poses.
        visitors: names of the visitors.
        held: name of the carried box; empty when none is carried.
    """
    arm = [int(i) for i in np.flatnonzero((model.geom_contype & ARM_BITS) != 0)]
    if held:
        arm.append(model.geom(held).id)
    ends = np.zeros(6)  # the two nearest points, which nobody asks for
    return {
        name: min(
            mujoco.mj_geomDistance(model, data, geom, model.geom(name).id, FARTHEST, ends) for geom in arm
        )
        for name in visitors
    }
