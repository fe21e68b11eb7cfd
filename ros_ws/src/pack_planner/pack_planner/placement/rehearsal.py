"""Rehearsals of entries: the new object is lowered into the container in simulation, without an arm.

It hangs on springs whose force is limited as the arm's push is (`pack_core/packing/steering.py`), and its
place is led down at a fixed speed, leaning and aside as the entry says.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from pack_core.packing.cell import PackingCell
from pack_core.packing.entry import Entry
from pack_core.packing.model import HeldRole
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, rotate, yaw_of
from pack_planner.placement.batch_physics import BatchPhysics

UP = np.array([0.0, 0.0, 1.0])
TIMESTEP = 0.01
SPEED = 0.15
"""Speed at which the object is lowered [m/s]."""
CLEARANCE = 0.01
"""Gap between the lower end and the obstacles' tops at the start [m]."""
REST = 0.25
"""Time for which everything may settle after the way down [s]."""
LOWEST_START = 0.05
"""Height at which the lower end starts when there are no obstacles [m]."""
DOWN_BELOW = 0.015
"""A lower end below this height has arrived [m]; the height at which INSERT is done."""
UPRIGHT = np.cos(np.deg2rad(20.0))
"""Objects that lean more have been tipped over."""


@dataclass(frozen=True)
class Rehearsed:
    """How n rehearsals went.

    Attributes:
        is_success: the object came down, and all stand between the walls `(n,)`.
        lags: how far it stayed above where it was led, over time `(n,)` [m s]: what resists costs.
    """

    is_success: npt.NDArray[np.bool_]
    lags: Array


class Rehearsal:
    """Rehearses entries of one scene's new object; the same for any number of threads."""

    def __init__(self, scene: Scene, cell: PackingCell, threads: int) -> None:
        """Build the model; `threads` 0 uses all cores."""
        self._scene = scene
        self._physics = BatchPhysics(scene, cell, timestep=TIMESTEP, held=HeldRole.STEERED, threads=threads)

    def run(self, poses: Mapping[str, Pose], goals: Sequence[Pose], entries: Sequence[Entry]) -> Rehearsed:
        """Lower the object to each goal X_WN by its entry, the others standing at `poses` to begin with."""
        paths = [self._way_down(X_WN, entry) for X_WN, entry in zip(goals, entries, strict=True)]
        steps = max(map(len, paths)) + round(REST / TIMESTEP)
        controls = np.stack([np.pad(path, ((0, steps - len(path)), (0, 0)), mode="edge") for path in paths])
        starts = np.stack([self._start(poses, path[0]) for path in paths])
        states = self._physics.roll_out(starts, controls)
        new = self._scene.new_object
        heights = self._of(new.name, states)[..., 2]
        is_down = heights[:, -1] - new.half_extents[2] < DOWN_BELOW
        lags = TIMESTEP * (heights - controls[..., 2]).sum(axis=1)
        return Rehearsed(is_down & self._is_orderly(states[:, -1]), lags)

    def _is_orderly(self, states: Array) -> npt.NDArray[np.bool_]:
        """Whether everything stands between the walls in the states `(n, nstate)`."""
        container, is_orderly = self._scene.container, np.ones(len(states), dtype=bool)
        for name in (*self._scene.names, self._scene.new_object.name):
            pose = self._of(name, states)
            is_between = np.all((pose[:, :2] > container.lower) & (pose[:, :2] < container.upper), axis=1)
            is_orderly &= is_between & (rotate(pose[:, 3:], UP)[:, 2] > UPRIGHT)
        return is_orderly

    def _way_down(self, X_WN: Pose, entry: Entry) -> Array:
        """Controls `(T, 6)`: wanted positions [m] and rotation vectors [rad], a box's nearest yaw to zero."""
        half_height = float(self._scene.new_object.half_extents[2])
        top = max((*entry.tops, LOWEST_START)) + CLEARANCE
        bottoms = np.append(np.arange(top, 0.0, -SPEED * TIMESTEP), 0.0)
        axes, asides = entry.at(bottoms)
        # a box looks the same after half a turn: the yaw nearest to zero keeps the rotation vector short
        yaw = (yaw_of(X_WN.q) + np.pi / 2) % np.pi - np.pi / 2
        # the object's z axis leans by its x and y components, that is, it turns about (-y, x)
        tilts = Rotation.from_rotvec(np.column_stack([-axes[:, 1], axes[:, 0], np.zeros(len(axes))]))
        turns = tilts * Rotation.from_rotvec([0.0, 0.0, yaw])
        places = X_WN.p[:2] + half_height * axes + asides
        return np.column_stack([places, bottoms + half_height, turns.as_rotvec()])

    def _start(self, poses: Mapping[str, Pose], control: Array) -> Array:
        """The state `(nstate,)` at rest with the new object where it is led to at first."""
        q_WN = Rotation.from_rotvec(control[3:]).as_quat(scalar_first=True)
        return self._physics.state({**poses, self._scene.new_object.name: Pose(control[:3], q_WN)})

    def _of(self, name: str, states: Array) -> Array:
        """Poses of an object `(..., 7)` in states `(..., nstate)`."""
        first = self._physics.column(name)
        return states[..., first : first + 7]
