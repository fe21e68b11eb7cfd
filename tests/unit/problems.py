"""Rearrangement problems from a few numbers."""

from __future__ import annotations

from collections.abc import Mapping

from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBE, CUBES, BlockSizes, PlacedBlock, Problem
from pack_planner.rearrangement.instances import square_workspace

Rows = Mapping[str, tuple[float, ...]]


def make_problem(
    starts: Rows, goals: Rows | None = None, size: float = 0.6, sizes: BlockSizes = CUBES, **fields: object
) -> Problem:
    """A problem from poses x, y [mm] and yaw [rad] by id; blocks that `sizes` does not name are cubes."""
    return Problem(
        blocks=tuple(PlacedBlock(name, pose(row), sizes.get(name, CUBE)) for name, row in starts.items()),
        goals={name: pose(row) for name, row in (goals or starts).items()},
        workspace=square_workspace(size), **fields,
    )  # fmt: skip


def pose(row: tuple[float, ...]) -> PlanarPose:
    x, y, *yaw = row
    return PlanarPose(1e-3 * x, 1e-3 * y, *yaw)
