"""Blocks scattered under the overhead camera, and pictures of them."""

from collections.abc import Mapping

import numpy as np

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.planar import PlanarPose
from pack_core.camera import Picture
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.blocks.simulator import BlocksSimulator

CELL = blocks_cell()
WORKSPACE = 0.539


def scattered(names: Mapping[str, int], seed: int) -> dict[str, PlanarPose]:
    """Poses over the workspace that do not overlap."""
    rng = np.random.default_rng(seed)
    free = CELL.block.edge * np.sqrt(2)
    poses: dict[str, PlanarPose] = {}
    while len(poses) < len(names):
        x, y = np.array(CELL.workspace.centre) + 0.5 * (WORKSPACE - free) * rng.uniform(-1, 1, 2)
        if all(np.hypot(x - p.x, y - p.y) > free for p in poses.values()):
            poses[list(names)[len(poses)]] = PlanarPose(float(x), float(y), float(rng.uniform(-np.pi, np.pi)))
    return poses


def photograph(camera: OverheadCamera, tags: Mapping[str, int], poses: Mapping[str, PlanarPose]) -> Picture:
    """The cell at rest with blocks at poses, the arm looking on."""
    return camera.picture(BlocksSimulator(CELL, tags, poses).snapshot())
