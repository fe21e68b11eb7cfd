"""Finds the box in front of the pad, by rays from the points that a seal must cover."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.robots.surface_gripper import TOOL, Seal
from pack_core.rotations import Array

BEHIND = 0.01
"""How far behind the pad's face the rays start, so that a face that is pressed into it is found [m]."""


@dataclass(frozen=True)
class FaceAhead:
    """The box that can be held and the seal that holds it; or no box, no seal, and the reason."""

    box: str
    seal: Seal | None
    reason: str


def face_ahead(
    model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str], seals: Sequence[Seal], reach: float
) -> FaceAhead:
    """Find the first seal whose points all meet the face of one box within `reach` [m].

    The body poses in `data` must be up to date. Seals are ordered from the largest to the smallest, so that
    the reason given when none fits is that of the smallest.
    """
    reason = ""
    for seal in seals:
        box, reason = _covering(model, data, boxes, seal, reach)
        if box:
            return FaceAhead(box, seal, "")
    return FaceAhead("", None, reason)


def _covering(
    model: mujoco.MjModel, data: mujoco.MjData, boxes: list[str], seal: Seal, reach: float
) -> tuple[str, str]:
    """The name of the box whose face covers a seal, and ""; or "" and the reason why there is none."""
    tool = data.body(TOOL)
    R_WT = tool.xmat.reshape(3, 3)
    starts = tool.xpos + (seal.points - [0.0, 0.0, BEHIND]) @ R_WT.T
    hits = [_hit(model, data, start, R_WT[:, 2], tool.id, reach + BEHIND) for start in starts]
    found = {hit for hit in hits if hit in boxes}
    if len(found) == 1 and len(set(hits)) == 1:
        return found.pop(), ""
    if not found:
        return "", f"no box within {1000 * reach:.0f} mm of the pad"
    if len(found) > 1:
        return "", f"the pad lies across {' and '.join(sorted(found))}"
    return "", f"the pad reaches beyond the face of {found.pop()}, or is tilted against it"


def _hit(
    model: mujoco.MjModel, data: mujoco.MjData, start: Array, axis: Array, tool: int, reach: float
) -> str:
    """Name of the body that a ray meets within `reach` [m]; empty when it meets none."""
    geom = np.zeros(1, dtype=np.int32)
    distance = mujoco.mj_ray(model, data, start, axis, None, True, tool, geom)  # -1 when nothing is met
    if distance < 0.0 or distance > reach:
        return ""
    return str(model.body(model.geom_bodyid[geom[0]]).name)
