"""Random problems: blocks scattered over a square workspace, a dense grid in its middle."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBE_SIDE, BlockSize, PlacedBlock, Point, Problem
from pack_core.errors import PackError
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import are_inside, edges, hits, outlines, rows_of, shapes_of

GRID_GAP = 0.002
"""Between blocks of the goal grid [m]."""
START_GAP = 0.003
"""Between blocks at the start, at least [m]."""
TRIES = 400
"""Poses drawn for a block before all blocks are drawn anew."""
RESTARTS = 2000
"""How often all blocks are drawn anew before a workspace counts as too full."""


EDGES = (0.040, 0.0508, 0.060, 0.072)
"""Of mixed blocks' tops [m]: as small as a tag can be read on, and as large as the gripper opens around."""
HEIGHTS = (0.045, 0.0508, 0.060)
"""Of mixed blocks [m]."""


def workspace_side(sizes: Sequence[BlockSize], density: float) -> float:
    """Of the square workspace [m] of whose area the blocks cover this share."""
    return math.sqrt(math.fsum(size.x * size.y for size in sizes) / density)


def square_workspace(length: float, centre: Point = (0.0, 0.0)) -> tuple[Point, ...]:
    """Corners [m] of a square workspace."""
    (x, y), half = centre, length / 2
    return ((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))


def make_instance(
    n: int, density: float, seed: int, *, symmetry: int = 1, centre: Point = (0.0, 0.0), mixed: bool = False
) -> Problem:
    """A problem with `n` blocks, by their density in the workspace.

    The goals are a grid, as square as n allows, in the middle of the workspace, ids in random order. The
    starts are uniform in position and yaw, START_GAP apart.

    Args:
        n: number of blocks.
        density: share of the square workspace that the blocks cover.
        seed: the same n, density, seed and kind of blocks give the same problem.
        symmetry: after how many equal turns a block looks alike.
        centre: of the workspace [m].
        mixed: cuboids of EDGES and HEIGHTS drawn at random, in rows of blocks equally deep; else equal cubes.

    Raises:
        PackError: the grid does not fit, or so many blocks cannot be scattered.
    """
    rng = np.random.default_rng([n, round(1000 * density), seed, *([1] if mixed else [])])
    sizes = _mixed_sizes(n, rng) if mixed else [BlockSize()] * n
    workspace = square_workspace(workspace_side(sizes, density), centre)
    grid = goal_rows(sizes, centre) if mixed else goal_grid(n, centre)
    tallest = max(size.z for size in sizes)
    if not are_inside(rows_of(grid), shapes_of(sizes, tallest), edges(workspace)).all():
        raise PackError(f"a grid of {n} blocks does not fit a workspace of density {density}: choose less")
    ids = [f"b{i + 1}" for i in range(n)]
    cells = rng.permutation(n)
    own = [sizes[cell] for cell in cells]
    starts = _scatter(shapes_of(own, tallest), workspace, rng)
    return Problem(
        blocks=tuple(
            PlacedBlock(name, PlanarPose(*row), size)
            for name, row, size in zip(ids, starts.tolist(), own, strict=True)
        ),
        goals={name: grid[cell] for name, cell in zip(ids, cells, strict=True)},
        workspace=workspace, symmetry=symmetry,
    )  # fmt: skip


def _mixed_sizes(n: int, rng: np.random.Generator) -> list[BlockSize]:
    """Sizes in the order of the grid's cells; those of a row are equally deep, so that the grid is dense."""
    columns = _columns(n)
    depths = rng.choice(EDGES, -(-n // columns))
    return [
        BlockSize(float(x), float(depths[i // columns]), float(z))
        for i, (x, z) in enumerate(zip(rng.choice(EDGES, n), rng.choice(HEIGHTS, n), strict=True))
    ]


def _columns(n: int) -> int:
    return math.ceil(n / math.isqrt(n))


def goal_grid(n: int, centre: Point = (0.0, 0.0), gap: float = GRID_GAP) -> list[PlanarPose]:
    """Cells of a grid of n cubes, row by row, as square as n allows; the last row may be shorter."""
    rows = math.isqrt(n)
    columns, pitch = math.ceil(n / rows), CUBE_SIDE + gap
    return [
        PlanarPose(
            centre[0] + pitch * (i % columns - (columns - 1) / 2),
            centre[1] + pitch * (i // columns - (rows - 1) / 2),
        )
        for i in range(n)
    ]


def goal_rows(
    sizes: Sequence[BlockSize], centre: Point = (0.0, 0.0), gap: float = GRID_GAP
) -> list[PlanarPose]:
    """Cells of a grid of mixed blocks: as many in a row as in that of cubes, every row centred."""
    columns = _columns(len(sizes))
    rows = [sizes[first : first + columns] for first in range(0, len(sizes), columns)]
    depths = [max(size.y for size in row) for row in rows]
    poses, y = [], centre[1] - (sum(depths) + gap * (len(rows) - 1)) / 2
    for row, depth in zip(rows, depths, strict=True):
        x = centre[0] - (sum(size.x for size in row) + gap * (len(row) - 1)) / 2
        for size in row:
            poses.append(PlanarPose(x + size.x / 2, y + depth / 2))
            x += size.x + gap
        y += depth + gap
    return poses


def _scatter(shapes: Array, workspace: tuple[Point, ...], rng: np.random.Generator) -> Array:
    for _ in range(RESTARTS):
        starts = _try_to_scatter(shapes, workspace, rng)
        if len(starts) == len(shapes):
            return starts
    raise PackError(
        f"{len(shapes)} blocks cannot be scattered {START_GAP * 1e3:.0f} mm apart: choose a lower density"
    )


def _try_to_scatter(shapes: Array, workspace: tuple[Point, ...], rng: np.random.Generator) -> Array:
    """Poses `(up to n, 3)`, one after the other, until one finds no room."""
    half_planes, corners = edges(workspace), np.array(workspace)
    placed = np.empty((0, 3))
    for shape in shapes:
        drawn = rng.uniform([*corners.min(0), -np.pi], [*corners.max(0), np.pi], (TRIES, 3))
        drawn = drawn[are_inside(drawn, shape, half_planes)]
        grown = outlines(drawn, shape, START_GAP)[:, None]
        free = drawn[~hits(grown, outlines(placed, shapes[: len(placed)])).any(axis=1)]
        if not len(free):
            break
        placed = np.vstack([placed, free[:1]])
    return placed
