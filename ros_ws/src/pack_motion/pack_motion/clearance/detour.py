"""A way around what height alone does not clear: RRT-Connect over poses of the tool.

Kuffner and LaValle, "RRT-Connect: an efficient approach to single-query path planning", 2000. Two trees grow
from both ends of the way towards poses drawn at random, and towards each other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from pack_core.rotations import Array, Pose, exp, multiply, rotate
from pack_motion.arm.arm import MotionArm

STEP = 0.3
"""Longest edge of a tree, as the time that its slowest joint takes at its velocity limit [s]."""
RESOLUTION = 0.015
"""Between the joint positions at which an edge is checked, likewise [s]."""
ITERATIONS = 600
"""Poses that are drawn before a search is given up."""
SHORTCUTS = 60
"""Pairs of points of a found way that are tried to be joined directly."""
HIGHEST = 1.0
"""How far above both ends poses are drawn [m]."""
NEAREST = 0.25
"""Share of the smaller distance of both ends from the arm's first axis, from which on poses are drawn."""
FARTHEST = 1.1
"""Share of the larger distance, up to which they are drawn."""


class Tree:
    """Joint positions and, for each, the index of the one it was reached from."""

    def __init__(self, root: Array) -> None:
        self._rows, self._n = np.empty((2 * ITERATIONS, len(root))), 1
        self._rows[0] = root
        self._parents = [-1]

    def add(self, q: Array, parent: int) -> int:
        """Add joint positions `(n,)`; their index."""
        if self._n == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        self._rows[self._n] = q
        self._parents.append(parent)
        self._n += 1
        return self._n - 1

    def nearest(self, q: Array, scale: Array) -> int:
        """The index of the nearest joint positions, each difference divided by `scale` `(n,)`."""
        return int(np.argmin(np.abs((self._rows[: self._n] - q) / scale).max(axis=1)))

    def at(self, index: int) -> Array:
        """Joint positions `(n,)` by their index."""
        return np.array(self._rows[index])

    def way(self, index: int) -> list[Array]:
        """Joint positions from an index back to the root."""
        found = []
        while index >= 0:
            found.append(self.at(index))
            index = self._parents[index]
        return found


class DetourSearch:
    """Searches ways of one arm.

    Args:
        arm: the arm that moves.
        is_clear: says whether joint positions `(T, n)` are clear enough.
        rng: draws poses; a search repeats with the same seed.
    """

    def __init__(self, arm: MotionArm, is_clear: Callable[[Array], bool], rng: np.random.Generator) -> None:
        self._arm, self._is_clear, self._rng = arm, is_clear, rng
        self._scale = arm.limits.velocity

    def way(self, q_start: Array, q_end: Array) -> list[Array] | None:
        """Joint positions from `q_start` to `q_end`, both of them clear, with straight edges between them.

        None where no way is found.
        """
        trees = [Tree(q_start), Tree(q_end)]
        for k, q in enumerate(self._draws(q_start, q_end)):
            one, other = trees if k % 2 == 0 else trees[::-1]
            added = self._extend(one, q)
            if added is None:
                continue
            target = one.at(added)
            met = self._connect(other, target)
            if met is not None:
                halves = one.way(added)[::-1], other.way(met)[1:]
                way = [*halves[0], *halves[1]]
                return self._shortened(way if k % 2 == 0 else way[::-1])
        return None

    def _draws(self, q_start: Array, q_end: Array) -> Iterator[Array]:
        """Joint positions with the tool held as at either end, turned with the arm about its first axis.

        A carried box so hangs on the way as it hangs at the ends. The first axis is vertical.
        """
        arm, ends = self._arm, (q_start, q_end)
        axis, origin = arm.chain.axes[0], arm.chain.points[0]
        tools = [arm.chain.forward(q) for q in ends]
        arms = [X.p - origin for X in tools]
        radii = [float(np.linalg.norm(p[:2])) for p in arms]
        lowest = NEAREST * min(radii), min(p[2] for p in arms)
        highest = FARTHEST * max(radii), max(p[2] for p in arms) + HIGHEST
        shoulder, elbow, _ = arm.inverse.branch(q_start)
        for _ in range(ITERATIONS):
            end = int(self._rng.integers(2))
            radius, height = self._rng.uniform(lowest, highest)
            turn = exp(float(self._rng.uniform(-np.pi, np.pi)) * axis)
            p = rotate(turn, np.array([*(radius / radii[end] * arms[end][:2]), height]))
            X_WT = Pose(origin + p, multiply(turn, tools[end].q))
            found = arm.inverse.candidates(X_WT, shoulder, elbow)
            if found:
                yield min(found, key=lambda q: self._length(ends[end], q))

    def _extend(self, tree: Tree, q: Array) -> int | None:
        """Grow a tree by one edge towards `q`; the index of its new end, None where the edge is not clear."""
        near = tree.nearest(q, self._scale)
        start = tree.at(near)
        length = self._length(start, q)
        if length < 1e-9:
            return near
        end = start + min(1.0, STEP / length) * (q - start)
        return tree.add(end, near) if self._is_edge_clear(start, end) else None

    def _connect(self, tree: Tree, q: Array) -> int | None:
        """Grow a tree up to `q` itself; None where something is in the way."""
        while True:
            reached = self._extend(tree, q)
            if reached is None or self._length(tree.at(reached), q) < 1e-9:
                return reached

    def _shortened(self, way: list[Array]) -> list[Array]:
        """The way without points between which a straight edge is clear, tried at random."""
        for _ in range(SHORTCUTS):
            if len(way) < 3:
                break
            i, j = sorted(int(k) for k in self._rng.choice(len(way), 2, replace=False))
            if j - i > 1 and self._is_edge_clear(way[i], way[j]):
                del way[i + 1 : j]
        return way

    def _is_edge_clear(self, start: Array, end: Array) -> bool:
        n = int(np.ceil(self._length(start, end) / RESOLUTION))
        return self._is_clear(np.linspace(start, end, n + 1))

    def _length(self, start: Array, end: Array) -> float:
        """The time that the slowest joint takes at its velocity limit [s]."""
        return float(np.abs((end - start) / self._scale).max())
