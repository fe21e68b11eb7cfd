"""When the controller has nothing to go by."""

from __future__ import annotations

from pack_core.states import SceneState


def blind_for(scene: SceneState, time: float) -> float:
    """For how long the cameras have seen no object at all by `time` [s].

    Physics carries single objects for longer, led by those that are seen; with none its errors only grow.
    """
    return time - scene.time + min((item.age for item in scene.objects.values()), default=0.0)
