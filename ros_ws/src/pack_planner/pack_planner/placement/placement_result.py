"""Result types of the placement planners."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Self

import numpy as np
import numpy.typing as npt

from pack_core.packing.entry import WayIn
from pack_core.packing.settled_sample import SettledSample
from pack_core.rotations import Array, Pose

SHOWN = 6
"""Number of samples that are shown as settled scenes."""


class PlacementStatus(IntEnum):
    """Outcome of planning, with the values of pack_interfaces/PlanPlacement."""

    SUCCESS = 1
    NO_FEASIBLE_PLACEMENT = 2


@dataclass(frozen=True)
class PlacementSamples:
    """The S poses that were tried.

    Attributes:
        names: names of all n objects, the new one last.
        sampled: X_WO of the new object as teleported `(S, 7)`: position [m], quaternion wxyz.
        scenes: X_WO of all objects after the physics has resolved the overlaps `(S, n, 7)`.
        costs: cost of each sample by Eq. 6 `(S,)`.
        is_feasible: whether each sample is a feasible placement `(S,)`.
    """

    names: tuple[str, ...]
    sampled: Array
    scenes: Array
    costs: Array
    is_feasible: npt.NDArray[np.bool_]

    @property
    def settled(self) -> Array:
        """X_WO of the new object after the physics has resolved the overlaps `(S, 7)`."""
        return self.scenes[:, -1]

    def spread(self, count: int) -> tuple[SettledSample, ...]:
        """At most `count` settled scenes: the cheapest, the dearest, and others evenly between them."""
        order = np.argsort(self.costs, kind="stable")
        places = np.unique(np.round(np.linspace(0, len(order) - 1, min(count, len(order)))).astype(int))
        # a single sample is the cheapest, which has none before it
        last = max(len(order) - 1, 1)
        return tuple(self._settled_sample(int(order[place]), place / last) for place in places.tolist())

    def _settled_sample(self, k: int, rank: float) -> SettledSample:
        poses = {name: Pose(row[:3], row[3:]) for name, row in zip(self.names, self.scenes[k], strict=True)}
        return SettledSample(float(self.costs[k]), rank, bool(self.is_feasible[k]), poses)


@dataclass(frozen=True)
class PlacementCandidate:
    """A packing pose that Algorithm 1 finds feasible.

    Attributes:
        X_WN: the pose of the new object N.
        collisions: objects that it overlaps where they stand now, the collision list G.
        cost: cost by Eq. 6.
        way: how it is to enter.
    """

    X_WN: Pose
    collisions: tuple[str, ...]
    cost: float
    way: WayIn = field(default_factory=WayIn)


@dataclass(frozen=True)
class PlannedPlacement:
    """Where to pack the new object.

    Attributes:
        status: whether a placement was found.
        reason: why none was found; empty after success.
        X_WO: the packing pose; None without success.
        collisions: objects that it overlaps where they stand now, the collision list G.
        way: how it is to enter.
        cost: cost of the chosen sample by Eq. 6; infinite without success.
        rehearsals: how many entries were rehearsed.
        samples: all samples that were tried.
    """

    status: PlacementStatus
    reason: str
    X_WO: Pose | None
    collisions: tuple[str, ...]
    way: WayIn
    cost: float
    rehearsals: int
    samples: PlacementSamples

    @classmethod
    def success(cls, chosen: PlacementCandidate, rehearsals: int, samples: PlacementSamples) -> Self:
        """The result with a placement that was chosen after so many rehearsals."""
        return cls(
            PlacementStatus.SUCCESS, "", chosen.X_WN, chosen.collisions, chosen.way, chosen.cost,
            rehearsals, samples,
        )  # fmt: skip

    @classmethod
    def failure(cls, reason: str, samples: PlacementSamples) -> Self:
        """The result when no sample is feasible."""
        status = PlacementStatus.NO_FEASIBLE_PLACEMENT
        return cls(status, reason, None, (), WayIn(), np.inf, 0, samples)

    @property
    def is_rehearsed(self) -> bool:
        """Whether the entry was rehearsed in simulation."""
        return self.rehearsals > 0
