"""The cell's MuJoCo model and state, rebuilt whenever a box is added or removed."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from pack_core.errors import PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.model import build_model
from pack_core.palletizing.visitors import Visitor
from pack_core.robots.kr210 import LIMITS, gear_joint
from pack_core.rotations import Array, Pose

OVERLAP = 0.001
"""A box that would overlap something by more than this cannot arrive [m]."""


class Physics:
    """Model and data; the model is built anew when a box comes or goes.

    The state of the arm, the boxes that stay and the grip is then copied over. What is set before every step,
    the belts' velocities and the gears' torques, is not.

    Args:
        cell: the cell's physical facts.
        timestep: time step of the integrator [s].
        X_WB: true pose of the arm's base.
        time: what the clock shows at the start [s].
        visitors: who comes near the arm.
        has_limits: whether joints have the published ranges, and motors the published torques.

    Attributes:
        motors: the motors' coordinates in qpos and qvel; the arm comes first in the model.
        gears: the gears' deflections in qpos and qvel; empty when they are rigid.
    """

    def __init__(
        self, cell: PalletizingCell, timestep: float, X_WB: Pose, time: float,
        visitors: Sequence[Visitor] = (), *, has_limits: bool = True,
    ) -> None:  # fmt: skip
        self._cell, self._timestep, self._X_WB = cell, timestep, X_WB
        self.visitors, self._has_limits = tuple(visitors), has_limits
        self._arm = list(LIMITS.names)
        self.motors, self.gears = slice(0, 6), slice(0, 0)
        if cell.imperfections.gears is not None:
            self._arm += [gear_joint(name) for name in LIMITS.names]
            # A gear's joint follows its motor's: even coordinates are motors, odd ones deflections.
            self.motors, self.gears = slice(0, 12, 2), slice(1, 12, 2)
        self.boxes: dict[str, BoxBody] = {}
        self.model, self.data = self._build()
        self.data.time = time
        self.move_visitors()
        self.data.qpos[self.motors] = cell.arm.home
        mujoco.mj_forward(self.model, self.data)

    def move_visitors(self) -> None:
        """Put every visitor where it is at the present time."""
        for visitor in self.visitors:
            now, i = visitor.at(float(self.data.time)).X_WV, self.model.body(visitor.name).mocapid[0]
            self.data.mocap_pos[i], self.data.mocap_quat[i] = now.p, now.q

    def add(self, box: BoxBody, X_WB: Pose) -> None:
        """Put a box into the cell, at rest.

        Raises:
            PackError: its name is taken, or something is in its place.
        """
        if box.name in self.boxes:
            raise PackError(f"box '{box.name}' is in the cell already; in it: {', '.join(self.boxes)}")
        before = self.boxes, self.model, self.data
        self.boxes = {**self.boxes, box.name: box}
        self._rebuild()
        q = self.model.joint(box.name).qposadr[0]
        self.data.qpos[q : q + 7] = [*X_WB.p, *X_WB.q]
        mujoco.mj_forward(self.model, self.data)
        if obstacle := self._overlapping(box.name):
            self.boxes, self.model, self.data = before
            raise PackError(f"no room for box '{box.name}': {obstacle} is in its place; clear it first")

    def remove(self, name: str) -> None:
        """Take a box out of the cell.

        Raises:
            PackError: there is no such box.
        """
        if name not in self.boxes:
            raise PackError(f"no box '{name}' in the cell; in it: {', '.join(self.boxes) or 'none'}")
        self.boxes = {other: box for other, box in self.boxes.items() if other != name}
        self._rebuild()
        mujoco.mj_forward(self.model, self.data)

    def link_angles(self) -> Array:
        """True joint angles of the links `(6,)` [rad]: the motors' angles plus the gears' deflections."""
        angles: Array = self.data.qpos[self.motors].copy()
        if self._cell.imperfections.gears is not None:
            angles += self.data.qpos[self.gears]
        return angles

    def _build(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        model = build_model(
            self._cell, list(self.boxes.values()), timestep=self._timestep, X_WB=self._X_WB,
            gears=self._cell.imperfections.gears, visitors=self.visitors,
        )  # fmt: skip
        if not self._has_limits:
            model.actuator_ctrllimited[:] = False
            for name in LIMITS.names:  # nor do hard stops end a joint's range
                model.joint(name).limited[:] = False
        return model, mujoco.MjData(model)

    def _rebuild(self) -> None:
        """Build the model for the present boxes and copy the state of every joint and grip, by name."""
        old_model, old = self.model, self.data
        self.model, self.data = model, data = self._build()
        data.time, data.ctrl[:] = old.time, old.ctrl
        self.move_visitors()
        # The solver's warm start is copied too: without it the step after a rebuild would differ.
        for name in (*self._arm, *(name for name in self.boxes if _has(old_model, name))):
            now, was = model.joint(name), old_model.joint(name)
            data.qpos[_span(now.qposadr, now.qpos0)] = old.qpos[_span(was.qposadr, was.qpos0)]
            for values, before in ((data.qvel, old.qvel), (data.qacc_warmstart, old.qacc_warmstart)):
                values[_span(now.dofadr, now.armature)] = before[_span(was.dofadr, was.armature)]
        for name in self.boxes:
            if _has(old_model, name):
                model.eq_data[model.equality(name).id] = old_model.eq_data[old_model.equality(name).id]
                data.eq_active[model.equality(name).id] = old.eq_active[old_model.equality(name).id]
                model.geom(name).conaffinity[:] = old_model.geom(name).conaffinity

    def _overlapping(self, name: str) -> str:
        """Name of a body that a box overlaps by more than `OVERLAP`; empty when there is none."""
        geom = self.model.geom(name).id
        for pair, distance in zip(self.data.contact.geom, self.data.contact.dist, strict=True):
            if geom in pair and distance < -OVERLAP:
                other = int(pair[0] + pair[1] - geom)  # the pair's geom that is not the box's own
                return str(self.model.body(self.model.geom_bodyid[other]).name)
        return ""


def _has(model: mujoco.MjModel, joint: str) -> bool:
    return bool(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint) >= 0)


def _span(address: np.ndarray, values: np.ndarray) -> slice:
    # The length comes from any field with one value per coordinate: 1 for a hinge, 7 or 6 for a free joint.
    return slice(int(address[0]), int(address[0]) + len(values))
