"""Random problems: blocks scattered over a square workspace, a dense grid in its middle."""

from __future__ import annotations

import math

import numpy as np

from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBE_SIDE, PlacedBlock, Point, Problem
from pack_core.errors import PackError
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import are_inside, edges, hits, squares

GRID_GAP = 0.002
"""Between blocks of the goal grid [m]."""
START_GAP = 0.003
"""Between blocks at the start, at least [m]."""
TRIES = 400
"""Poses drawn for a block before all blocks are drawn anew."""
RESTARTS = 2000
"""How often all blocks are drawn anew before a workspace counts as too full."""


def workspace_side(n: int, density: float, side: float = CUBE_SIDE) -> float:
    """Of the square workspace [m] in which n blocks cover this share of the area."""
    return math.sqrt(n * side**2 / density)


def square_workspace(length: float, centre: Point = (0.0, 0.0)) -> tuple[Point, ...]:
    """Corners [m] of a square workspace."""
    (x, y), half = centre, length / 2
    return ((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))


def make_instance(
    n: int, density: float, seed: int, *, symmetry: int = 1, centre: Point = (0.0, 0.0)
) -> Problem:
    """A problem with `n` blocks, by their density in the workspace.

    The goals are a grid, as square as n allows, in the middle of the workspace, ids in random order. The
    starts are uniform in position and yaw, START_GAP apart.

    Args:
        n: number of blocks.
        density: rho = n side^2 / W^2 of a workspace of side W.
        seed: the same n, density and seed give the same problem.
        symmetry: after how many equal turns a block looks alike.
        centre: of the workspace [m].

    Raises:
        PackError: the grid does not fit, or so many blocks cannot be scattered.
    """
    rng = np.random.default_rng([n, round(1000 * density), seed])
    workspace = square_workspace(workspace_side(n, density), centre)
    grid = goal_grid(n, centre)
    if not are_inside(np.array([pose.row for pose in grid]), CUBE_SIDE, edges(workspace)).all():
        raise PackError(f"a grid of {n} blocks does not fit a workspace of density {density}: choose less")
    ids = [f"b{i + 1}" for i in range(n)]
    cells = rng.permutation(n)
    starts = _scatter(n, workspace, rng)
    return Problem(
        blocks=tuple(
            PlacedBlock(name, PlanarPose(*row)) for name, row in zip(ids, starts.tolist(), strict=True)
        ),
        goals={name: grid[cell] for name, cell in zip(ids, cells, strict=True)},
        workspace=workspace, symmetry=symmetry,
    )  # fmt: skip


def goal_grid(n: int, centre: Point = (0.0, 0.0), gap: float = GRID_GAP) -> list[PlanarPose]:
    """Cells of a grid of n blocks, row by row, as square as n allows; the last row may be shorter."""
    rows = math.isqrt(n)
    columns, pitch = math.ceil(n / rows), CUBE_SIDE + gap
    return [
        PlanarPose(
            centre[0] + pitch * (i % columns - (columns - 1) / 2),
            centre[1] + pitch * (i // columns - (rows - 1) / 2),
        )
        for i in range(n)
    ]


def _scatter(n: int, workspace: tuple[Point, ...], rng: np.random.Generator) -> Array:
    for _ in range(RESTARTS):
        starts = _try_to_scatter(n, workspace, rng)
        if len(starts) == n:
            return starts
    raise PackError(f"{n} blocks cannot be scattered {START_GAP * 1e3:.0f} mm apart: choose a lower density")


def _try_to_scatter(n: int, workspace: tuple[Point, ...], rng: np.random.Generator) -> Array:
    """Poses `(up to n, 3)`, one after the other, until one finds no room."""
    half_planes, corners = edges(workspace), np.array(workspace)
    placed = np.empty((0, 3))
    while len(placed) < n:
        drawn = rng.uniform([*corners.min(0), -np.pi], [*corners.max(0), np.pi], (TRIES, 3))
        drawn = drawn[are_inside(drawn, CUBE_SIDE, half_planes)]
        grown = squares(drawn, CUBE_SIDE, START_GAP)[:, None]
        free = drawn[~hits(grown, squares(placed, CUBE_SIDE)).any(axis=1)]
        if not len(free):
            break
        placed = np.vstack([placed, free[:1]])
    return placed
