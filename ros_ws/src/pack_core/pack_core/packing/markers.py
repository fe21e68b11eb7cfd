"""What motion capture measures in one frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


@dataclass(frozen=True)
class MarkerFrame:
    """One motion capture frame with n visible markers.

    Attributes:
        time: time of exposure [s].
        objects: names of the objects, indexed by `object_index`.
        object_index: object that each marker belongs to `(n,)`.
        marker_index: row `(n,)` of each marker in `markers()` of its object's model.
        p_WM: measured marker positions in the world `(n, 3)` [m].
        cameras: number of cameras that see each marker `(n,)`.
    """

    time: float
    objects: tuple[str, ...]
    object_index: npt.NDArray[np.int_]
    marker_index: npt.NDArray[np.int_]
    p_WM: Array
    cameras: npt.NDArray[np.int_]
