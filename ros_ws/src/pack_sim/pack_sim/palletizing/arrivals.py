"""The random pose at which a box arrives on the picking table."""

from __future__ import annotations

import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Pose, from_yaw


def arrival_pose(cell: PalletizingCell, box: BoxBody, seed: int) -> Pose:
    """X_WB of a box that arrives near the middle of the picking table, displaced and turned at random.

    The same seed and box give the same pose, whichever boxes arrived before: each box has its own generator.
    """
    rng = np.random.default_rng([seed, box.look])
    offset = rng.uniform(-cell.spawn.offset, cell.spawn.offset, 2)
    yaw = np.deg2rad(rng.uniform(-cell.spawn.yaw_deg, cell.spawn.yaw_deg))
    x, y = np.array(cell.picking_table.centre) + offset
    level = Pose(np.array([x, y, cell.picking_table.height + box.half_extents[2]]), from_yaw(yaw))
    return cell.picking_table.displaced(level)
