"""Branch and bound over the choices for each pair of boxes: the axis that parts it, and which box is first.

A node of the search is a set of relations along each axis. The least displacements that fulfil them are a
lower bound for all that descends from the node, since every further relation can only raise their cost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_planner.layout.axis_program import AxisProgram, Relation

TOLERANCE = 1e-8
"""A gap counts as reached when less than this is missing [m]."""

Node = tuple[frozenset[Relation], ...]
"""The relations along each axis."""
Choice = tuple[int, Relation]
"""An index of an axis and a relation of two boxes along it."""


@dataclass
class Search:
    """Finds the cheapest displacements that part all pairs.

    Attributes:
        programs: one for each axis.
        pairs: the boxes that must be apart along one axis or the other.
        limit: the largest number of nodes that are tried.
        displacements: the cheapest found so far `(n, 2)` [m].
        cost: the cost of those displacements.
        tried: number of nodes tried so far.
    """

    programs: Sequence[AxisProgram]
    pairs: Sequence[Relation]
    limit: int
    displacements: Array | None = None
    cost: float = float("inf")
    tried: int = 0

    @property
    def is_complete(self) -> bool:
        """Whether every choice that could be cheaper was tried."""
        return self.tried <= self.limit

    def run(self) -> None:
        """Search depth first, starting from no relation at all."""
        nodes: list[Node] = [(frozenset(), frozenset())]
        while nodes and self.is_complete:
            nodes += reversed(self._branch(nodes.pop()))

    def _branch(self, relations: Node) -> list[Node]:
        """The nodes that descend from one and may be cheaper than the best so far, the cheapest first."""
        self.tried += 1
        if not self.is_complete:
            return []
        solved = [program.solve(chosen) for program, chosen in zip(self.programs, relations, strict=True)]
        ways = [way for way in solved if way is not None]
        cost = sum(way[1] for way in ways)
        if len(ways) < len(solved) or cost >= self.cost * (1.0 - TOLERANCE):
            return []
        displacements = np.stack([way[0] for way in ways], axis=1)
        choices = self._next_choices(displacements)
        if choices is None:
            self.displacements, self.cost = displacements, cost
            return []
        return [
            (*relations[:axis], relations[axis] | {relation}, *relations[axis + 1 :])
            for axis, relation in choices
        ]

    def _next_choices(self, displacements: Array) -> list[Choice] | None:
        """The ways to part the next pair, the smallest correction first; None when all pairs are apart.

        The next pair is the one whose second-best way needs the largest correction: most is lost there if
        the best way is not taken, so that the search fixes it early.
        """
        least: list[Choice] | None = None
        regret = -1.0
        for pair in self.pairs:
            corrections = sorted(self._corrections(pair, displacements))
            if corrections[0][0] > TOLERANCE and corrections[1][0] > regret:
                regret = corrections[1][0]
                least = [choice for correction, choice in corrections if correction <= self._reach]
        return least

    def _corrections(self, pair: Relation, displacements: Array) -> list[tuple[float, Choice]]:
        """The correction [m] that each of the four ways to part a pair needs: gap less distance, Eq. 6.1."""
        return [
            (float(program.gap - program.lower[j] - shifts[j] + program.upper[i] + shifts[i]), (axis, (i, j)))
            for axis, (program, shifts) in enumerate(zip(self.programs, displacements.T, strict=True))
            for i, j in (pair, pair[::-1])
        ]

    @property
    def _reach(self) -> float:
        """Largest correction of a pair [m]: two boxes, each displaced from one limit to the other."""
        return 4.0 * self.programs[0].max_shift
