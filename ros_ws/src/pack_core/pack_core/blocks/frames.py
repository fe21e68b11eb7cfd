"""Frames of the blocks cell that stand still, for /tf_static."""

from __future__ import annotations

import numpy as np

from pack_core.blocks.cell import BlocksCell
from pack_core.rotations import Pose


def fixed_frames(cell: BlocksCell) -> dict[str, tuple[str, Pose]]:
    """X_PF and the parent's name P, by the name of frame F.

    `table` is the middle of the table's top, `workspace` the middle of where blocks may be, and
    `overhead_camera` that of the pictures: z forward, x to the right, y down.
    """
    return {
        "table": ("world", Pose(np.array([*cell.table.centre, 0.0]))),
        "workspace": ("world", Pose(np.array([*cell.workspace.centre, 0.0]))),
        "overhead_camera": ("world", cell.camera.pinhole.X_WC),
    }
