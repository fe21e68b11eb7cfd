"""Marker frames as arrays with one row for each object and one column for each marker."""

from __future__ import annotations

import numpy as np

from pack_core.errors import MessageError
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_perception.mocap.alignment import Mask


class MarkerTable:
    """Positions of the m markers of each of the n objects of a scene.

    Attributes:
        names: names of the objects, the new one last.
        p_BM: marker positions in the objects' frames `(n, m, 3)` [m].
    """

    def __init__(self, scene: Scene) -> None:
        self.names = [*scene.names, scene.new_object.name]
        self.p_BM = np.stack([scene.model_of(name).markers() for name in self.names])

    def sort(self, frame: MarkerFrame) -> tuple[Array, Mask]:
        """Measured positions p_WM `(n, m, 3)` [m], and which of them the frame has `(n, m)`.

        Raises:
            MessageError: the frame has an object or a marker that the scene does not have.
        """
        unknown = set(frame.objects) - set(self.names)
        if unknown:
            raise MessageError(f"frame with objects {sorted(unknown)}; the scene has {self.names}")
        count = self.p_BM.shape[1]
        if np.any((frame.marker_index < 0) | (frame.marker_index >= count)):
            raise MessageError(f"frame with marker {frame.marker_index.max()}; objects have 0 to {count - 1}")
        p_WM, visible = np.zeros_like(self.p_BM), np.zeros(self.p_BM.shape[:2], dtype=bool)
        rows = np.array([self.names.index(name) for name in frame.objects], dtype=int)[frame.object_index]
        p_WM[rows, frame.marker_index] = frame.p_WM
        visible[rows, frame.marker_index] = True
        return p_WM, visible
