"""The true distance of every visitor from the arm, its tool and the carried box; for whoever looks on."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from pack_core.robots.kr210 import ARM_BITS

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
