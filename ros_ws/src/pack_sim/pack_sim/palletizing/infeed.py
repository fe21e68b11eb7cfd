"""The conveyor of a shift: two belts with their own speeds, light barriers, and the boxes that come on them.

The belt on which boxes queue runs until one of them has gone over to table A, the faster belt, and the next
one is at the seam; table A runs until a box stands at the barrier where it is picked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import mujoco
import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PICKING_TABLE, QUEUE_BELT, PalletizingCell
from pack_core.palletizing.infeed import InfeedState
from pack_core.rotations import Pose, from_yaw
from pack_sim.palletizing.physics import Physics

BEAM = 0.03
"""Height of the light barriers over the belts [m]."""
UPSTREAM = 0.04
"""Of the seam, where the second barrier is: a box stops in time before it [m]."""
LOOK_PAUSE = 0.1
"""Between two looks whether there is room for the next box [s]."""
BEYOND = 0.05
"""Of the belts' sides, where the barriers' lamps are [m]."""


@dataclass(frozen=True)
class ArrivingBox:
    """A box that somebody puts on the conveyor.

    Attributes:
        body: the box; its name is what it is tracked by.
        label: what its bar code says; empty where it cannot be read.
        yaw: about the vertical, from its long side along the belt [rad].
        offset: of its middle from that of the belt, across it [m].
        gap: to the box before it, at least [m].
    """

    body: BoxBody
    label: str
    yaw: float
    offset: float
    gap: float

    @property
    def half_length(self) -> float:
        """Half of what it covers along the belt [m]."""
        x, y, _ = self.body.half_extents
        return float(abs(x * np.cos(self.yaw)) + abs(y * np.sin(self.yaw)))


class BeltMode(Enum):
    """What table A does."""

    FILLING = "a box comes"
    CLEARING = "a box is on it and goes on to the barrier"
    HOLDING = "a box stands at the barrier"


class Infeed:
    """Runs the belts and puts boxes on them.

    Args:
        cell: where the conveyor is.
        arrivals: what comes; the conveyor runs empty where it ends.
    """

    def __init__(self, cell: PalletizingCell, arrivals: Iterator[ArrivingBox]) -> None:
        assert cell.shift is not None
        self._config, self._arrivals = cell.shift.infeed, arrivals
        self._table, self._belt = cell.picking_table, cell.queue_belt
        length, queue = 0.5 * self._table.size[0], 0.5 * self._belt.size[0]
        self._pick_x = self._table.centre[0] - length + self._config.barrier
        self._seam_x = self._table.centre[0] + length + UPSTREAM
        self._start_x = self._belt.centre[0] + queue
        self._speeds = {PICKING_TABLE: 0.0, QUEUE_BELT: 0.0}
        self._mode, self._is_at_seam, self._front = BeltMode.HOLDING, False, ""
        self._next = next(arrivals, None)
        self._labels: dict[str, str] = {}
        self._number = 0
        self._look = 0.0

    def send(self) -> None:
        """Let the next box come, once the one at the barrier is gone."""
        if self._mode is BeltMode.HOLDING:
            self._mode, self._front = BeltMode.FILLING, ""

    def state(self, time: float) -> InfeedState:
        """What the conveyor tells."""
        is_there = self._mode is BeltMode.HOLDING
        box = self._front if is_there else ""
        return InfeedState(time, self._number, box, self._labels.get(box, ""))

    def step(self, physics: Physics) -> None:
        """Look at the barriers, and move the belts for one step of the physics."""
        self._switch(physics)
        wanted = {
            PICKING_TABLE: 0.0 if self._mode is BeltMode.HOLDING else self._config.pick_speed,
            QUEUE_BELT: self._config.queue_speed if self._lets_in else 0.0,
        }
        change = self._config.acceleration * physics.model.opt.timestep
        for name, speed in wanted.items():
            self._speeds[name] += float(np.clip(speed - self._speeds[name], -change, change))
            joint = physics.model.joint(name)
            physics.data.qpos[joint.qposadr[0]] = 0.0
            physics.data.qvel[joint.dofadr[0]] = -self._speeds[name]  # towards the arm is -x

    def bring(self, physics: Physics) -> bool:
        """Put the next box on the conveyor once there is room for it; whether that was now."""
        box = self._next
        if box is None or physics.data.time < self._look:
            return False
        self._look = float(physics.data.time) + LOOK_PAUSE
        x = self._start_x - box.half_length
        room = x - box.half_length - box.gap
        if any(self._last_x(physics, other) > room for other in physics.boxes.values()):
            return False
        p = np.array([
            x, self._belt.centre[1] + box.offset, self._belt.height + box.body.half_extents[2],
        ])  # fmt: skip
        physics.add(box.body, Pose(p, from_yaw(box.yaw)))
        self._next, self._labels[box.body.name] = next(self._arrivals, None), box.label
        return True

    def forget(self, name: str) -> None:
        """Note that a box has left the cell."""
        self._labels.pop(name, None)

    @property
    def _lets_in(self) -> bool:
        """Whether the belt with the queue runs: a box is wanted, or the next one is not at the seam yet."""
        return self._mode is BeltMode.FILLING or not self._is_at_seam

    def _switch(self, physics: Physics) -> None:
        """What follows from the light barriers."""
        if self._mode is BeltMode.HOLDING and self._is_at_seam:
            return
        was_at_seam, self._is_at_seam = self._is_at_seam, bool(self._in_beam(physics, self._seam_x))
        if self._mode is BeltMode.FILLING and was_at_seam and not self._is_at_seam:
            self._mode = BeltMode.CLEARING
        if self._mode is not BeltMode.HOLDING and (front := self._in_beam(physics, self._pick_x)):
            self._mode, self._front = BeltMode.HOLDING, front
            self._number += 1

    def _in_beam(self, physics: Physics, x: float) -> str:
        """Name of the box that interrupts the barrier at `x` [m]; empty where it is free."""
        y, width, z = self._table.centre[1], self._table.size[1], self._table.height + BEAM
        geom = np.array([-1], dtype=np.int32)
        reach = width + 2.0 * BEYOND
        start = np.array([x, y - 0.5 * reach, z])
        distance = mujoco.mj_ray(
            physics.model, physics.data, start, np.array([0.0, 1.0, 0.0]), None, True, -1, geom, None
        )
        if not 0.0 <= distance <= reach:
            return ""
        name = str(physics.model.body(physics.model.geom_bodyid[geom[0]]).name)
        return name if name in physics.boxes else ""

    def _last_x(self, physics: Physics, box: BoxBody) -> float:
        """The end of a box on the queue belt, as far up it as it reaches [m]; -inf for one elsewhere."""
        joint = physics.model.joint(box.name).qposadr[0]
        x, y, z, *q = physics.data.qpos[joint : joint + 7]
        is_on_belt = (
            abs(y - self._belt.centre[1]) < 0.5 * self._belt.size[1]
            and x > self._seam_x and abs(z - self._belt.height - box.half_extents[2]) < BEAM
        )  # fmt: skip
        if not is_on_belt:
            return -np.inf
        yaw = 2.0 * np.arctan2(q[3], q[0])
        half_x, half_y, _ = box.half_extents
        return float(x + abs(half_x * np.cos(yaw)) + abs(half_y * np.sin(yaw)))
