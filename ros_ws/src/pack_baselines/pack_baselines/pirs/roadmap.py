"""The PRM planner of the paper, compiled: the cheapest way of one block, and the blocks in its way.

An edge is an action: carrying the block, by either grasp, or pushing it. Edges have directions, and a pair of
nodes may have several. What an edge hits of the blocks that may be moved adds to its cost (Eq. 1); an edge
that hits another block does not exist. Edges are priced when Dijkstra's algorithm comes to them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_baselines.pirs.geometry import (
    Sizes,
    block_hits,
    grasp_hits,
    is_inside,
    is_push,
    push_hits,
    rectangle_at,
)
from pack_core.blocks.planar import QUARTER
from pack_core.rotations import Array

PUSHED = 4
"""Instead of a pair of grasps: the edge is a push."""


class Prices(NamedTuple):
    """The parameters alpha_1, alpha_2 and alpha_3 of Eq. 1, and the prices that Section V proposes.

    Attributes:
        pick_place: alpha_1.
        push: alpha_2.
        collision: alpha_3.
        distance: of a metre that the block is moved, by either action [1/m].
        push_length: of a metre of pushing, beyond `distance` [1/m].
    """

    pick_place: float
    push: float
    collision: float
    distance: float = 0.0
    push_length: float = 0.0


class Way(NamedTuple):
    """A path through the roadmap; without nodes where there is none.

    Attributes:
        poses: nodes on the way `(edges + 1, 3)`.
        grasps: of every edge, 2 * axis at its start + axis at its end, or PUSHED `(edges,)`.
        blocks: in the way, as bits.
    """

    poses: Array
    grasps: npt.NDArray[np.int64]
    blocks: np.uint64


@njit(cache=True)
def shortest_way(
    nodes: Array, outlines: Array, movable: np.uint64, fixed: np.uint64, is_symmetric: bool, prices: Prices,
    sizes: Sizes,
) -> Way:  # fmt: skip
    """Dijkstra's algorithm from node 0 to node 1 of `(nodes, 3)`."""
    n = nodes.shape[0]
    picks, places = grasps_at(nodes, sizes, outlines)
    cost, parent = np.full(n, np.inf), np.full(n, -1)
    used, hits = np.full(n, -1), np.zeros(n, np.uint64)
    is_done = np.zeros(n, np.bool_)
    cost[0] = 0.0
    for _ in range(n):
        i = -1
        for j in range(n):
            if not is_done[j] and cost[j] < np.inf and (i < 0 or cost[j] < cost[i]):
                i = j
        if i < 0 or i == 1:
            break
        is_done[i] = True
        for j in range(n):
            if not is_done[j]:
                price, edge, blocks = cheapest_edge(
                    nodes[i],
                    nodes[j],
                    picks[i],
                    places[j],
                    outlines,
                    movable,
                    fixed,
                    is_symmetric,
                    prices,
                    sizes,
                )
                if cost[i] + price < cost[j]:
                    cost[j], parent[j], used[j], hits[j] = cost[i] + price, i, edge, blocks
    return _way_back(nodes, parent, used, hits)


@njit(cache=True)
def grasps_at(
    nodes: Array, sizes: Sizes, outlines: Array
) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.uint64]]:
    """What picking and placing at the nodes hits, by either grasp `(nodes, 2)` each."""
    picks, places = np.empty((len(nodes), 2), np.uint64), np.empty((len(nodes), 2), np.uint64)
    for i in range(len(nodes)):
        below = block_hits(nodes[i], sizes, outlines)
        for k in range(2):
            picks[i, k] = grasp_hits(nodes[i], k, sizes, outlines)
            places[i, k] = picks[i, k] | below
    return picks, places


@njit(cache=True)
def cheapest_edge(
    start: Array, end: Array, picks: npt.NDArray[np.uint64], places: npt.NDArray[np.uint64], outlines: Array,
    movable: np.uint64, fixed: np.uint64, is_symmetric: bool, prices: Prices, sizes: Sizes,
) -> tuple[float, int, np.uint64]:  # fmt: skip
    """Price, kind and blocks in the way of the cheapest action from pose to pose; infinite for none."""
    best, kind, in_the_way = np.inf, -1, np.uint64(0)
    length = np.hypot(end[0] - start[0], end[1] - start[1])
    carry = prices.pick_place + prices.distance * length
    for k in range(2):
        for turned in range(1 + is_symmetric):
            blocks = picks[k] | places[k ^ turned]
            price = carry + prices.collision * _count(blocks & movable)
            can_grasp = sizes.can_grasp[k] and sizes.can_grasp[k ^ turned]
            if can_grasp and not blocks & fixed and price < best:
                best, kind, in_the_way = price, 2 * k + (k ^ turned), blocks & movable
    push = prices.push + (prices.distance + prices.push_length) * length
    if push < best and is_push(start, end, is_symmetric, sizes):
        blocks = push_hits(start, end, sizes, outlines)
        price = push + prices.collision * _count(blocks & movable)
        if not blocks & fixed and price < best:
            best, kind, in_the_way = price, PUSHED, blocks & movable
    return best, kind, in_the_way


@njit(cache=True)
def _way_back(
    nodes: Array, parent: npt.NDArray[np.int64], used: npt.NDArray[np.int64], hits: npt.NDArray[np.uint64]
) -> Way:
    length, j = 0, 1
    while parent[j] >= 0:
        length, j = length + 1, parent[j]
    poses, grasps, blocks = np.empty((length + 1, 3)), np.empty(length, np.int64), np.uint64(0)
    j = 1
    for edge in range(length - 1, -1, -1):
        poses[edge + 1], grasps[edge] = nodes[j], used[j]
        blocks |= hits[j]
        j = parent[j]
    poses[0] = nodes[0]
    return Way(poses, grasps, blocks)


@njit(cache=True)
def way_hits(way: Way, sizes: Sizes, outlines: Array) -> np.uint64:
    """Blocks `(n, 6)` in the way, for blocks that stand elsewhere now."""
    blocks = np.uint64(0)
    for edge in range(len(way.grasps)):
        start, end, kind = way.poses[edge], way.poses[edge + 1], way.grasps[edge]
        if kind == PUSHED:
            blocks |= push_hits(start, end, sizes, outlines)
        else:
            blocks |= grasp_hits(start, kind // 2, sizes, outlines) | block_hits(end, sizes, outlines)
            blocks |= grasp_hits(end, kind % 2, sizes, outlines)
    return blocks


@njit(cache=True)
def _count(blocks: np.uint64) -> int:
    total = 0
    while blocks:
        blocks &= blocks - np.uint64(1)
        total += 1
    return total


TRIES = 40
"""Poses drawn for every one that is wanted, at most."""
GOAL_SHARE = 0.75
"""Of the poses on push lines: on those of the path's end; the others are on those of its start."""


@njit(cache=True)
def draw_pose(corners: Array, rng: np.random.Generator) -> Array:
    """Uniform in the bounding box of the corners `(n, 2)`, of any yaw."""
    pose = np.empty(3)
    for axis in range(2):
        pose[axis] = rng.uniform(corners[:, axis].min(), corners[:, axis].max())
    pose[2] = rng.uniform(-np.pi, np.pi)
    return pose


@njit(cache=True)
def draw_on_line(pose: Array, sizes: Sizes, rng: np.random.Generator) -> Array:
    """On one of the four lines on which a push leads to the pose or away from it."""
    heading = pose[2] + QUARTER * rng.integers(0, 4)
    distance = rng.uniform(sizes.min_push, sizes.max_push)
    return np.array([pose[0] + distance * np.cos(heading), pose[1] + distance * np.sin(heading), pose[2]])


@njit(cache=True)
def sample_nodes(
    start: Array, end: Array, count: int, bias: float, fixed: np.uint64, sizes: Sizes, outlines: Array,
    half_planes: Array, corners: Array, rng: np.random.Generator,
) -> Array:  # fmt: skip
    """Start, end and up to `count` poses between them that hit none of the `fixed` blocks `(nodes, 3)`.

    With probability `bias` a pose is drawn on a push line, the narrow passage into a dense grid.
    """
    nodes = np.empty((count + 2, 3))
    nodes[0], nodes[1] = start, end
    found = 2
    for _ in range(TRIES * count):
        if found == count + 2:
            break
        if rng.uniform(0.0, 1.0) < bias:
            pose = draw_on_line(end if rng.uniform(0.0, 1.0) < GOAL_SHARE else start, sizes, rng)
        else:
            pose = draw_pose(corners, rng)
        if is_inside(pose, sizes, half_planes) and not block_hits(pose, sizes, outlines) & fixed:
            nodes[found] = pose
            found += 1
    return nodes[:found]


@njit(cache=True)
def sample_clear_pose(
    start: Array, way: Way, way_sizes: Sizes, others: np.uint64, wanted: int, tries: int, sizes: Sizes,
    outlines: Array, half_planes: Array, corners: Array, rng: np.random.Generator,
) -> Array:  # fmt: skip
    """A pose at which a block hits none of the `others` and is not in the way `(1, 3)`; else `(0, 3)`.

    Of up to `wanted` such poses, from `tries` draws at most, it is the one nearest to `start` `(3,)`.
    """
    nearest, least, found = np.empty((1, 3)), np.inf, 0
    for _ in range(tries):
        if found == wanted:
            break
        pose = draw_pose(corners, rng)
        if is_clear(pose, way, way_sizes, others, sizes, outlines, half_planes):
            found += 1
            distance = np.hypot(pose[0] - start[0], pose[1] - start[1])
            if distance < least:
                least = distance
                nearest[0] = pose
    return nearest[: min(found, 1)]


@njit(cache=True)
def is_clear(
    pose: Array, way: Way, way_sizes: Sizes, others: np.uint64, sizes: Sizes, outlines: Array,
    half_planes: Array,
) -> bool:  # fmt: skip
    """A block at the pose is inside the workspace, hits none of the `others` and is not in the way.

    The way is that of another block, of `way_sizes`.
    """
    if not is_inside(pose, sizes, half_planes) or block_hits(pose, sizes, outlines) & others:
        return False
    outline = np.empty((1, 6))
    outline[0] = rectangle_at(pose, 0.0, 0.0, sizes.edges[0] / 2, sizes.edges[1] / 2)
    return not way_hits(way, way_sizes, outline)
