"""Tool poses from joint positions."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from pack_core.kinematics.chain import SerialChain, chain_from_model
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.robots.kr210 import JOINTS
from pack_core.robots.surface_gripper import TOOL
from pack_core.rotations import Array
from pack_evaluation.palletizing.run import ToolTrack


def tool_track(times: Array, q_ref: Array, q: Array, q_true: Array | None = None) -> ToolTrack:
    """The commanded and the measured tool poses at `times` `(n,)` from joint positions `(n, 6)` [rad].

    Args:
        times: the moments [s].
        q_ref: commanded.
        q: measured.
        q_true: true angles of the links, where they are known.
    """
    p_true = None if q_true is None else _poses(q_true)[0]
    return ToolTrack(times, q, *_poses(q_ref), *_poses(q), p_true)


@cache
def _chain() -> SerialChain:
    return chain_from_model(build_model(palletizing_cell()), JOINTS, TOOL)


def _poses(rows: Array) -> tuple[Array, Array]:
    """Positions `(n, 3)` and quaternions wxyz `(n, 4)`."""
    poses = [_chain().forward_matrix(row) for row in rows]
    rotations = Rotation.from_matrix(np.array([R for R, _ in poses]))
    return np.array([p for _, p in poses]), rotations.as_quat(scalar_first=True)
