"""The moves that led to the states of a beam search."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from pack_planner.rearrangement.beam.pushing import Ints
from pack_planner.rearrangement.beam.states import Children


@dataclass(frozen=True)
class BlockMove:
    """A block goes to a spot; stage and grasps as in Children."""

    block: int
    spot: int
    stage: int
    grasps: int


@dataclass
class History:
    """A tree of moves; its nodes are numbered in the order in which they were added, the root is 0."""

    _chunks: list[Ints] = field(default_factory=lambda: [np.full((1, 5), -1, dtype=np.int32)])
    size: int = 1

    def add(self, parents: Ints, children: Children, kept: npt.NDArray[np.int64]) -> Ints:
        """Record children `kept` of layers whose nodes are `parents`; their numbers."""
        chunk = children.moves[kept]
        chunk[:, 0] = parents[chunk[:, 0]]
        self._chunks.append(chunk)
        numbers = np.arange(self.size, self.size + len(kept), dtype=np.int32)
        self.size += len(kept)
        return numbers

    def moves(self, node: int) -> list[BlockMove]:
        """The moves that lead from the root to a node."""
        rows = np.concatenate(self._chunks)
        path = []
        while node > 0:
            parent, *move = rows[node].tolist()
            path.append(BlockMove(*move))
            node = parent
        return path[::-1]
