"""The scanners that measure the heights of what stands on the pallet and on table B, and what they measured.

A scanner is a 3D camera that hangs over the middle of its place. Its frame S is that of a camera: z forward,
which is down, x to the right. Each of its rays brings the point that it meets.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.imperfections import NOWHERE, Displacement
from pack_core.rotations import POINTING_DOWN, Array, Pose, from_yaw, multiply


class ScannerMount(Config):
    """Where a scanner hangs over its place, and the grid of its rays."""

    height: PositiveFloat
    """Over the floor [m]."""
    spacing: Annotated[float, Field(ge=0.002)]
    """Between rays, at the level of the place [m]."""
    turn_deg: float
    """By which the grid is turned against the edges of the place, about the vertical."""
    margin: NonNegativeFloat
    """So far beyond the edges of the place it looks [m]."""
    displacement: Displacement = NOWHERE
    """From there, about the scanner itself."""

    def X_WS(self, middle: Array) -> Pose:
        """Where it is, of a place whose middle is `(3,)` [m]."""
        p_WS = np.array([*middle[:2], self.height])
        level = Pose(p_WS, multiply(from_yaw(np.deg2rad(self.turn_deg)), POINTING_DOWN))
        return self.displacement.applied(level, p_WS)

    def rays(self, middle: Array, size: tuple[float, float]) -> Array:
        """Directions of its rays `(n, 3)` in S, of length 1.

        Args:
            middle: of the place as it nominally stands `(3,)` [m].
            size: of the place along the world's x and y [m].
        """
        depth, half = self.height - middle[2], 0.5 * np.array(size) + self.margin
        reach = float(np.linalg.norm(half))
        steps = np.arange(-reach, reach + self.spacing, self.spacing)
        grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
        # R_WS of the level scanner, in the plane: the grid is kept where it meets the place in the world.
        turn = np.deg2rad(self.turn_deg)
        R = np.array([[np.cos(turn), np.sin(turn)], [np.sin(turn), -np.cos(turn)]])
        wanted = grid[np.all(np.abs(grid @ R.T) <= half, axis=1)]
        directions = np.column_stack([wanted, np.full(len(wanted), depth)])
        return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


class Scanners(Config):
    """The scanners by the name of the place that each looks at."""

    pallet: ScannerMount
    reorientation_table: ScannerMount


SCANNED = tuple(Scanners.model_fields)
"""Names of the places that a scanner looks at."""


def scanner_frame(place: str) -> str:
    """Name of the frame of the scanner over a place."""
    return f"{place}_scanner"


@dataclass(frozen=True)
class PlaceScan:
    """What a scanner measured.

    Attributes:
        time: when [s].
        place: name of the place, one of `SCANNED`.
        points: where its rays met something `(n, 3)` [m] in S; rays that brought nothing are left out.
    """

    time: float
    place: str
    points: Array
