"""What an iteration plans from: the newest measurements, and what they lack."""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.joints import JointSample
from pack_core.packing.model import parked_pose
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_core.states import ObjectState, SceneState


@dataclass(frozen=True)
class PackingObservation:
    """What an iteration plans from.

    Attributes:
        joints: newest sample of the joints.
        scene: newest estimate of the objects.
        forces: external forces since the last observation `(n, 3)` [N], in the axes of /wrench.
        is_held: whether the pump holds the object.
        zeroed: when the force sensor was last set to zero with an empty cup [s]; None if nobody said so.
    """

    joints: JointSample
    scene: SceneState
    forces: Array
    is_held: bool = True
    zeroed: float | None = None


def blind_for(scene: SceneState, time: float) -> float:
    """For how long the cameras have seen no object at all by `time` [s].

    Physics carries single objects for longer, led by those that are seen; with none its errors only grow.
    """
    return time - scene.time + min((item.age for item in scene.objects.values()), default=0.0)


def unseen_of(scene: Scene, state: SceneState) -> tuple[str, ...]:
    """Names of the objects of the scene that the estimate lacks."""
    return tuple(name for name in scene.names if name not in state.objects)


def with_parked(scene: Scene, state: SceneState) -> SceneState:
    """The estimate, completed by objects that nobody has seen, out of everything's way."""
    parked = {
        item.name: ObjectState(parked_pose(i, item))
        for i, item in enumerate(scene.objects)
        if item.name not in state.objects
    }
    return SceneState(state.time, {**state.objects, **parked})
