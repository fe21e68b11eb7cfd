"""What is in front of the pad: rays from its middle and its corners, as a seal would find it."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.robots.surface_gripper import TOOL
from pack_core.rotations import Array

INSET = 0.8
"""Share of the pad's half side at which the corner rays start."""
BEHIND = 0.01
"""How far behind the pad's face the rays start, so that a face that is pressed into it is found [m]."""


def face_ahead(
    model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str], *, pad_size: float, reach: float
) -> tuple[str, str]:
    """The box whose face covers the whole pad within `reach` [m]; needs up-to-date kinematics.

    Returns:
        The box's name, or empty and why there is none.
    """
    tool = data.body(TOOL)
    R_WT = tool.xmat.reshape(3, 3)
    starts = tool.xpos + (_pattern(pad_size) - [0.0, 0.0, BEHIND]) @ R_WT.T
    hits = [_hit(model, data, start, R_WT[:, 2], tool.id, reach + BEHIND) for start in starts]
    found = {hit for hit in hits if hit in boxes}
    if len(found) == 1 and len(set(hits)) == 1:
        return found.pop(), ""
    if not found:
        return "", f"no box within {1000 * reach:.0f} mm of the pad"
    if len(found) > 1:
        return "", f"the pad lies across {' and '.join(sorted(found))}"
    return "", f"the pad reaches beyond the face of {found.pop()}, or is tilted against it"


def _pattern(pad_size: float) -> Array:
    """Middle and corners `(5, 3)` in the tool frame [m]."""
    h = 0.5 * INSET * pad_size
    return np.array([[0, 0, 0], [h, h, 0], [h, -h, 0], [-h, h, 0], [-h, -h, 0]], dtype=float)


def _hit(
    model: mujoco.MjModel, data: mujoco.MjData, start: Array, axis: Array, tool: int, reach: float
) -> str:
    """Name of the body that a ray meets within `reach`; empty when none."""
    geom = np.zeros(1, dtype=np.int32)
    distance = mujoco.mj_ray(model, data, start, axis, None, True, tool, geom)
    if distance < 0.0 or distance > reach:
        return ""
    return str(model.body(model.geom_bodyid[geom[0]]).name)
