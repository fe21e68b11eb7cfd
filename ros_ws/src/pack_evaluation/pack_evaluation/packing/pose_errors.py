"""How far poses that were estimated or predicted are from the true ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.rotations import Array
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track


def position_errors(run: Run, tracks: Mapping[str, Track]) -> Array:
    """Distances [m] from true positions during the goal, of all objects in the container in one array.

    Their mean is M_pos (Eq. 7) where the tracks are those of the controller's model. Objects without a track,
    which no camera has seen, are left out.
    """
    windows = [(name, _window(run, tracks[name])) for name in run.scene.names if name in tracks]
    errors = [track.distance_to(run.truth[name].at(track.times).p) for name, track in windows]
    return np.concatenate(errors) if errors else np.empty(0)


def held_position_errors(run: Run, tracks: Mapping[str, Track]) -> Array:
    """Distances `(T,)` [m] of the held object from its true positions during the goal."""
    if run.held not in tracks:
        return np.empty(0)
    track = _window(run, tracks[run.held])
    return track.distance_to(run.truth[run.held].at(track.times).p)


def held_rotation_errors(run: Run, tracks: Mapping[str, Track]) -> Array:
    """Angles `(T,)` [rad] of the held object from its true orientations during the goal.

    Their mean is M_rot (Eq. 8) where the tracks are those of the controller's model.
    """
    if run.held not in tracks:
        return np.empty(0)
    track = _window(run, tracks[run.held])
    return track.angle_to(run.truth[run.held].at(track.times))


def _window(run: Run, track: Track) -> Track:
    return track.between(run.start, run.end)
