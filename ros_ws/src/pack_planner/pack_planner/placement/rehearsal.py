"""Rehearsals of entries: the new object is lowered into the container in simulation, without an arm.

It hangs on springs whose force is limited like the arm's (`pack_core/packing/model.py`). The springs' rest
pose moves down at a fixed speed, with the tilt and offset of the entry.
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
from pack_core.rotations import Array, Pose, rotate, tilts, yaw_of
from pack_planner.placement.batch_physics import BatchPhysics

UP = np.array([0.0, 0.0, 1.0])
TIMESTEP = 0.01
"""Step of the physics [s]."""
SPEED = 0.15
"""Speed at which the springs' rest pose moves down [m/s]."""
CLEARANCE = 0.01
"""Gap between the lower end and the obstacles' tops at the start [m]."""
REST = 0.25
"""Time for which everything may settle after the object was lowered [s]."""
LOWEST_START = 0.05
"""Height at which the lower end starts when there are no obstacles [m]."""
DOWN_BELOW = 0.015
"""The object has arrived when its lower end is below this height [m]; INSERT ends at the same height."""
UPRIGHT = np.cos(np.deg2rad(20.0))
"""Cosine of the tilt beyond which an object counts as tipped over."""


@dataclass(frozen=True)
class Rehearsed:
    """Outcome of n rehearsals.

    Attributes:
        is_success: whether the object came down and all objects stand between the walls `(n,)`.
        lags: time integral `(n,)` of how far the object stayed above the springs' rest pose [m s]; it grows
            with resistance.
    """

    is_success: npt.NDArray[np.bool_]
    lags: Array


class Rehearsal:
    """Rehearses entries of a scene's new object; results do not depend on the number of threads.

    Attributes:
        count: how many rehearsals there were.
    """

    def __init__(self, scene: Scene, cell: PackingCell, threads: int) -> None:
        """Build the model; `threads` 0 uses all cores."""
        self._scene, self.count = scene, 0
        symmetry = scene.new_object.symmetry
        # half a turn, as of boxes and of what is round, or what the object's own symmetry is
        looks_alike = symmetry == 0.0 or np.isclose(np.pi / symmetry, np.round(np.pi / symmetry))
        self._turn = np.pi if looks_alike else symmetry
        self._physics = BatchPhysics(scene, cell, timestep=TIMESTEP, held=HeldRole.STEERED, threads=threads)

    def run(self, poses: Mapping[str, Pose], goals: Sequence[Pose], entries: Sequence[Entry]) -> Rehearsed:
        """Lower the object to each goal X_WN by its entry, the others standing at `poses` at the start."""
        paths = [self._way_down(X_WN, entry) for X_WN, entry in zip(goals, entries, strict=True)]
        steps = max(map(len, paths)) + round(REST / TIMESTEP)
        controls = np.stack([np.pad(path, ((0, steps - len(path)), (0, 0)), mode="edge") for path in paths])
        starts = np.stack([self._start(poses, path[0]) for path in paths])
        self.count += len(goals)
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
            is_orderly &= is_between & self._is_upright(name, pose)
        return is_orderly

    def _is_upright(self, name: str, pose: Array) -> npt.NDArray[np.bool_]:
        """Whether an object stands at poses `(n, 7)`: a capsule that lies may have rolled."""
        item = self._scene.model_of(name)
        q_WO = np.array([item.standing(Pose(row[:3], row[3:])).q for row in pose])
        return np.asarray(rotate(q_WO, UP)[:, 2] > UPRIGHT)

    def _way_down(self, X_WN: Pose, entry: Entry) -> Array:
        """Controls `(T, 6)` of the springs: desired positions [m] and rotation vectors [rad]."""
        half_height = float(self._scene.new_object.half_extents[2])
        top = max((*entry.tops, LOWEST_START)) + CLEARANCE
        bottoms = np.append(np.arange(top, 0.0, -SPEED * TIMESTEP), 0.0)
        axes, asides = entry.at(bottoms)
        # the yaw nearest to zero at which the object looks the same keeps the rotation vector short
        turn = self._turn
        yaw = (yaw_of(X_WN.q) + turn / 2) % turn - turn / 2
        # the sine of a tilt, which the axes have, stands for the tilt: it is 6 % less at an entry of 0.6 rad
        turns = Rotation.from_rotvec(tilts(axes)) * Rotation.from_rotvec([0.0, 0.0, yaw])
        # the centre is half a height up the leaning axis from the lower end
        places = X_WN.p[:2] + half_height * axes + asides
        return np.column_stack([places, bottoms + half_height, turns.as_rotvec()])

    def _start(self, poses: Mapping[str, Pose], control: Array) -> Array:
        """The state `(nstate,)` at rest with the new object at the first desired pose."""
        q_WN = Rotation.from_rotvec(control[3:]).as_quat(scalar_first=True)
        return self._physics.state({**poses, self._scene.new_object.name: Pose(control[:3], q_WN)})

    def _of(self, name: str, states: Array) -> Array:
        """Poses of an object `(..., 7)` in states `(..., nstate)`."""
        first = self._physics.column(name)
        return states[..., first : first + 7]
