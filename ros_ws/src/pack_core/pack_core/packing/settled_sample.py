"""A sample of Algorithm 1 as a settled scene, which the planner hands out and the report draws (Fig. 3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pack_core.rotations import Pose


@dataclass(frozen=True)
class SettledSample:
    """One sample after the physics has resolved its overlaps.

    Attributes:
        cost: cost by Eq. 6.
        rank: share of all samples that are cheaper: 0 for the cheapest, 1 for the dearest.
        is_feasible: whether the sample is a feasible placement.
        poses: X_WO of every object by its name, the new one last.
    """

    cost: float
    rank: float
    is_feasible: bool
    poses: Mapping[str, Pose]
