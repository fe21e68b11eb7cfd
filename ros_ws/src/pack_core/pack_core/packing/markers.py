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
        time: of exposure [s].
        objects: names that `object_index` points into.
        object_index: `(n,)`.
        marker_index: `(n,)`, row of `markers()` of the object's model.
        p_WM: positions `(n, 3)` [m].
        cameras: how many cameras see each `(n,)`.
    """

    time: float
    objects: tuple[str, ...]
    object_index: npt.NDArray[np.int_]
    marker_index: npt.NDArray[np.int_]
    p_WM: Array
    cameras: npt.NDArray[np.int_]
