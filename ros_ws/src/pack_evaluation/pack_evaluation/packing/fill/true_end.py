"""How a fill job truly ended, by where its objects are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pack_core.packing.free_space import Fill, fill_of, is_packed
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose

NEAR_HAND_OVER = 0.1
"""An object that ends this near to where it was handed over was put aside there, or never left it [m]."""


@dataclass(frozen=True)
class TrueEnd:
    """How a job truly ended.

    Attributes:
        inside: names of the objects that are in the container.
        outside: names of objects that are neither there nor where they were handed over.
        fill: how full the container is.
    """

    inside: tuple[str, ...]
    outside: tuple[str, ...]
    fill: Fill


def true_end(scene: Scene, poses: Mapping[str, tuple[Pose, Pose]]) -> TrueEnd:
    """Judge where objects ended.

    Args:
        scene: the container, and all objects.
        poses: X_WO at the hand-over and at the end, by name.
    """
    inside = tuple(name for name, (_, last) in poses.items() if is_packed(scene, last))
    outside = tuple(
        name
        for name, (first, last) in poses.items()
        if name not in inside and np.linalg.norm(last.p[:2] - first.p[:2]) > NEAR_HAND_OVER
    )
    fill = fill_of(scene.container, [(scene.model_of(name), poses[name][1]) for name in inside])
    return TrueEnd(inside, outside, fill)
