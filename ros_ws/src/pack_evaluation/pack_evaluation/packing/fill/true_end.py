"""Where the objects of a fill job truly are at its end, from their recorded paths."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pack_core.packing.free_space import Fill, fill_of, is_packed
from pack_core.packing.scene import Scene
from pack_evaluation.track import Track

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


def true_end(scene: Scene, paths: Mapping[str, Track], end: float) -> TrueEnd:
    """Judge the last pose of every object.

    Args:
        scene: the container, and all objects.
        paths: from an object's hand-over until it is taken out of the cell, or the recording ends.
        end: time of the job's end [s].
    """
    until = {name: path.between(-np.inf, end) for name, path in paths.items()}
    poses = {name: (path.pose(0), path.pose(-1)) for name, path in until.items() if path.times.size}
    inside = tuple(name for name, (_, last) in poses.items() if is_packed(scene, last))
    outside = tuple(
        name
        for name, (first, last) in poses.items()
        if name not in inside and np.linalg.norm(last.p[:2] - first.p[:2]) > NEAR_HAND_OVER
    )
    fill = fill_of(scene.container, [(scene.model_of(name), poses[name][1]) for name in inside])
    return TrueEnd(inside, outside, fill)
