"""Tests whether a finished stack stays in place when pushed: EUMOS 40509, unwrapped, at a given acceleration.

The acceleration is reached within 50 ms, kept for 0.3 s and taken away again, along each of the pallet's
four sides in turn; it acts on everything, as when the floor under the pallet is accelerated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.model import build_model
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import GRAVITY
from pack_core.rotations import Array, Pose

RAMP, HOLD, REST = 0.05, 0.3, 0.5
"""Times in which the acceleration rises, for which it is kept, and for which the stack then rests [s]."""
SIDES = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
"""Horizontal directions in which the stack is accelerated."""


def standing(boxes: Sequence[PlacedBox], cell: PalletizingCell) -> dict[BoxBody, Pose]:
    """Boxes on the cell's pallet as bodies at their places; their own axes are those of the pallet."""
    stack = {}
    for box in boxes:
        x, y, z = (float(edge) for edge in box.size)
        X_WB = Pose(cell.pallet.X_WP.apply(box.centre), cell.pallet.X_WP.q)
        stack[BoxBody(box.id, (x, y, z), box.mass)] = X_WB
    return stack


def hold_shift_mm(cell: PalletizingCell, boxes: Mapping[BoxBody, Pose], acceleration: float = 0.2) -> float:
    """Largest permanent shift of any box on the pallet [mm], over the four sides.

    Args:
        cell: the cell's physical facts.
        boxes: the stack as it stands.
        acceleration: as a share of gravity.
    """
    model = build_model(cell, list(boxes))
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)  # a change of gravity wakes no box
    shifts = [_shift(model, cell, boxes, acceleration * np.array(side)) for side in SIDES]
    return 1e3 * max(shifts, default=0.0)


def _shift(
    model: mujoco.MjModel, cell: PalletizingCell, boxes: Mapping[BoxBody, Pose], acceleration: Array
) -> float:
    data = mujoco.MjData(model)
    for box, X_WB in boxes.items():
        q = model.joint(box.name).qposadr[0]
        data.qpos[q : q + 7] = [*X_WB.p, *X_WB.q]
    home = np.array(cell.arm.home)
    start = {box: X_WB.p for box, X_WB in boxes.items()}
    while data.time < 2 * RAMP + HOLD + REST:
        share = np.clip(min(data.time / RAMP, (2 * RAMP + HOLD - data.time) / RAMP), 0.0, 1.0)
        model.opt.gravity[:2] = -GRAVITY * share * acceleration
        # The arm's joints come first in the model; it is held at its home posture.
        data.qpos[: len(home)], data.qvel[: len(home)] = home, 0.0
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    return max(float(np.linalg.norm(data.body(box.name).xpos - p)) for box, p in start.items())
