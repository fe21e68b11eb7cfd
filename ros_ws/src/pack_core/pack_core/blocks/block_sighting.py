"""What tag perception says about the blocks on the table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pack_core.blocks.planar import PlanarPose


@dataclass(frozen=True)
class BlockSighting:
    """One picture's worth of blocks.

    Attributes:
        time: when the picture was taken [s].
        poses: X_WB of every block that was seen, by id.
        missing: ids of blocks whose tag was not seen.
        doubled: ids of blocks whose tag was seen more than once; their pose is not told.
        unknown: numbers of tags that belong to no block.
    """

    time: float
    poses: Mapping[str, PlanarPose]
    missing: tuple[str, ...] = ()
    doubled: tuple[str, ...] = ()
    unknown: tuple[int, ...] = ()

    @property
    def is_complete(self) -> bool:
        """Every block was seen exactly once."""
        return not self.missing and not self.doubled
