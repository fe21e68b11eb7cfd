"""The stage LOOK: while an object of the scene has no pose, the arm moves out of the cameras' way.

The held object, the pump and the arm hide what is below them. From above the container they hide other parts
of it, and from beside it the least. Objects that hide one another stay hidden: no look pose helps them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, rotate, yaw_of
from pack_mpc.target import PackingTarget, Stage
from pack_mpc.task.stages import UP, ChosenPlacement


class LookConfig(Config):
    """Where the held object goes so that the cameras see what it hides, and for how long."""

    height: PositiveFloat = Field(
        default=0.25, description="height of the held object's lower end over the rim while looking [m]"
    )
    aside: PositiveFloat = Field(
        default=0.1, description="gap between the container and the held object beside it [m]"
    )
    near: PositiveFloat = Field(
        default=0.03, description="a look pose is reached within this distance of it [m]"
    )
    dwell: PositiveFloat = Field(default=0.2, description="time for the cameras at a look pose [s]")
    travel_time: PositiveFloat = Field(
        default=3.0, description="time after which a look pose that is not reached is given up [s]"
    )


@dataclass(frozen=True)
class LookPose:
    """A place from which to look.

    Attributes:
        words: the place in words.
        p_WN: position `(3,)` of the held object [m].
        axis: x and y `(2,)` of the held object's z axis there; zero means upright.
    """

    words: str
    p_WN: Array
    axis: Array = field(default_factory=lambda: np.zeros(2))


def look_poses(scene: Scene, config: LookConfig, X_WN: Pose) -> list[LookPose]:
    """Where to look from, one place after the other: here, straight above, then beside the container.

    Here comes first, as a goal may have been accepted before the first marker frame. The way up keeps the
    object's tilt, as it may stand among the others; all other ways are above the rim.
    """
    container, half_extents = scene.container, scene.new_object.half_extents
    tilt = rotate(X_WN.q, UP)[:2]
    height = max(float(X_WN.p[2]), scene.rim + config.height + float(half_extents[2]))
    # Half the diagonal of its base: how far the held object reaches sideways, whatever its yaw.
    reach = container.wall + float(np.linalg.norm(half_extents[:2])) + config.aside
    (x, y), (left, right) = container.centre, (container.upper[1] + reach, container.lower[1] - reach)
    return [
        LookPose("where it was", X_WN.p.copy(), tilt),
        LookPose("above", np.array([*X_WN.p[:2], height]), tilt),
        LookPose("left of the container", np.array([x, left, height])),
        LookPose("right of it", np.array([x, right, height])),
        # On the arm's own side of the container, neither it nor the object is between cameras and objects.
        LookPose("between it and the base", np.array([container.lower[0] - reach, y, height])),
    ]


class LookMachine:
    """Goes from look pose to look pose; the caller says which objects are still unseen.

    It is the other `GoalMachine`, which stands in for the `StageMachine` while there is no placement.

    Args:
        scene: the container and the held object.
        config: where to look from, and for how long.
        time: current time [s].
        X_WN: the held object's current pose.
    """

    stage = Stage.LOOK
    halt = 0.0
    """LOOK has no progress that could halt."""

    def __init__(self, scene: Scene, config: LookConfig, time: float, X_WN: Pose) -> None:
        self._scene, self._config = scene, config
        self._poses, self._i = look_poses(scene, config, X_WN), 0
        self._q, self._yaw = X_WN.q, yaw_of(X_WN.q)
        self._X_WN, self._last_move, self._arrival = X_WN, time, np.inf
        self.stage_start = time
        self.unseen: tuple[str, ...] = ()
        self.is_exhausted = False

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects in the container; it is looked from the same poses."""
        self._scene = scene

    @property
    def target(self) -> PackingTarget:
        """Where the held object shall go."""
        pose = self._poses[self._i]
        return PackingTarget(pose.p_WN, self._yaw, pose.axis)

    @property
    def placement(self) -> ChosenPlacement:
        """The look pose in the form of a placement, for status and logs."""
        return ChosenPlacement(Pose(self._poses[self._i].p_WN, self._q))

    @property
    def is_out(self) -> bool:
        """Whether the held object's lower end, were it upright, is above the container and the objects."""
        return float(self._X_WN.p[2] - self._scene.new_object.half_extents[2]) >= self._scene.rim

    def distance(self, p_WN: Array) -> float:
        """Distance [m] from the held object to the look pose."""
        return float(np.linalg.norm(p_WN - self._poses[self._i].p_WN))

    def update(self, time: float, X_WN: Pose, unseen: tuple[str, ...]) -> bool:
        """Go on to the next look pose once the cameras had their time at this one, or it is out of reach.

        Args:
            time: current time [s].
            X_WN: the held object's current pose.
            unseen: names of the objects without a pose.

        Returns:
            Whether the target changed.
        """
        self._X_WN, self.unseen = X_WN, unseen
        if self.distance(X_WN.p) < self._config.near:
            self._arrival = min(self._arrival, time)
        has_looked = time - self._arrival >= self._config.dwell
        if not has_looked and time - self._last_move < self._config.travel_time:
            return False
        # An object that did not come out of the container must not be dragged over its wall.
        may_go_on = self._i == 0 or self.is_out
        if not may_go_on or self._i + 1 == len(self._poses):
            self.is_exhausted = True
            return False
        self._i, self._last_move, self._arrival = self._i + 1, time, np.inf
        return True

    @property
    def report(self) -> str:
        """Which objects no camera has seen, and from where they were looked for."""
        tried = ", ".join(pose.words for pose in self._poses[: self._i + 1])
        return f"no camera has seen enough markers of {', '.join(self.unseen)}, with the held object {tried}"
