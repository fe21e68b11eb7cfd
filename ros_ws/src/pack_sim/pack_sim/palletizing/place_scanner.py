"""The simulated scanners over the pallet and over table B: rays through the physics, with noise."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Annotated

import mujoco
import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.scanner import PlaceScan
from pack_core.rotations import Array, rotate

REACH = 6.0
"""Nothing farther away is measured [m]."""


@dataclass(frozen=True)
class PhysicsSnapshot:
    """The state of the physics at `time` [s], with body poses, for whoever looks at it in another thread."""

    time: float
    model: mujoco.MjModel
    data: mujoco.MjData


class PlaceScannerConfig(Config):
    """What a scan is like.

    The figures are of the size that makers of time-of-flight cameras state for one picture at four metres:
    a few millimetres of noise, some pixels without a value, a result after 0.1 s.
    """

    noise: NonNegativeFloat = Field(default=0.003, description="of a measured distance, one sigma [m]")
    lost: Annotated[float, Field(ge=0, lt=1, description="share of the rays that bring nothing")] = 0.01
    latency: NonNegativeFloat = Field(
        default=0.1, description="from a scan to its result, in runs without ROS [s]"
    )


class PlaceScanner:
    """Scans the places of the cell as it truly is.

    Args:
        cell: where the scanners truly hang.
        config: errors of a scan.
        seed: of the noise; the same place at the same time has the same noise.
    """

    def __init__(self, cell: PalletizingCell, config: PlaceScannerConfig, seed: int) -> None:
        self._config, self._seed = config, seed
        self._X_WS = {place: cell.scanner_pose(place) for place in cell.scanned}
        self._rays = {place: cell.scanner_rays(place) for place in cell.scanned}

    def scan(self, place: str, still: PhysicsSnapshot) -> PlaceScan:
        """What the scanner over a place measures of a state of the physics."""
        X_WS, rays = self._X_WS[place], self._rays[place]
        distances = _distances(still, X_WS.p, rotate(X_WS.q, rays))
        rng = np.random.default_rng([self._seed, zlib.crc32(place.encode()), round(1e6 * still.time)])
        measured = distances + rng.normal(0.0, self._config.noise, len(rays))
        is_found = (distances >= 0.0) & (rng.random(len(rays)) >= self._config.lost)
        return PlaceScan(still.time, place, (measured[:, None] * rays)[is_found])


def _distances(still: PhysicsSnapshot, p_WS: Array, rays_W: Array) -> Array:
    """Distances `(n,)` [m] from a point along rays `(n, 3)` of length 1 to what they meet; -1 for nothing."""
    n = len(rays_W)
    distances, geoms = np.empty(n), np.empty(n, dtype=np.int32)
    mujoco.mj_multiRay(
        still.model, still.data, p_WS, rays_W.ravel(), None, True, -1, geoms, distances, None, n, REACH
    )
    return distances
