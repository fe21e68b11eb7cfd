"""Where an order's boxes are to stand, as translucent shapes on the pallet."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import mujoco
import numpy as np
from viser import GlbHandle, SceneApi

from pack_viewer.geom_meshes import box_glb
from pack_viewer.model_scene import scene_name

CUBE, TEXT = 1, 9
"""Types of visualization_msgs/Marker: a box, and the text over it that names it."""
COLOUR = (0.34, 0.71, 0.91, 0.22)


class OrderPlaces:
    """The places of an order; each is hidden once its box stands there."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._handles: dict[str, GlbHandle] = {}
        self._model = mujoco.MjSpec().compile()

    @property
    def count(self) -> int:
        """How many boxes the order has; 0 while none is known."""
        return len(self._handles)

    def set(self, markers: Sequence[Any]) -> None:
        """Take up a cell's goal markers: a box, then its name, again and again."""
        self.clear()
        boxes = [marker for marker in markers if marker.type == CUBE and marker.scale.x > 0.0]
        names = [str(marker.text) for marker in markers if marker.type == TEXT]
        for name, marker in zip(names, boxes, strict=False):
            half = 0.5 * np.array([marker.scale.x, marker.scale.y, marker.scale.z])
            p, q = marker.pose.position, marker.pose.orientation
            self._handles[name] = self._scene.add_glb(
                f"/places/{scene_name(name)}", box_glb(self._model, half, rgba=COLOUR),
                position=(p.x, p.y, p.z), wxyz=(q.w, q.x, q.y, q.z), cast_shadow=False, receive_shadow=False,
            )  # fmt: skip

    def take(self, names: Collection[str]) -> None:
        """Hide the places of boxes that stand there, and no others."""
        for name, handle in self._handles.items():
            if handle.visible == (name in names):
                handle.visible = name not in names

    def clear(self) -> None:
        """There is no order."""
        for handle in self._handles.values():
            handle.remove()
        self._handles = {}
