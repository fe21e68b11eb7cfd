"""Task stages PRE-PACK, INSERT, FINE-TUNE, and the stall detector (section III-B2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.packing.entry import Entry
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, rotate, yaw_of
from pack_mpc.target import PackingTarget, Stage

UP = np.array([0.0, 0.0, 1.0])
"""Vertical direction, in the world and, before it is turned, along the object's own z axis."""


class PressConfig(Config):
    """How the force builds up at a halt."""

    force: NonNegativeFloat = Field(default=22.0, description="largest force down at a halt [N]; 0: none")
    rate: PositiveFloat = Field(default=40.0, description="by how much it grows each second [N/s]")
    delay: NonNegativeFloat = Field(default=0.15, description="length of a halt from which on it grows [s]")

    def after(self, halt: float) -> float:
        """The force down [N] once the object has made no progress for `halt` [s]."""
        return min(self.force, self.rate * max(halt - self.delay, 0.0))


class StageConfig(Config):
    """When a stage is done, and when it has stalled."""

    clearance: PositiveFloat = Field(
        default=0.015, description="pre-packing height over the tallest object [m]"
    )
    pre_pack_distance: PositiveFloat = Field(
        default=0.02, description="PRE-PACK is done within this distance of its target [m]"
    )
    insert_height: PositiveFloat = Field(
        default=0.015, description="INSERT is done at this height over the place [m]"
    )
    placed_distance: PositiveFloat = Field(
        default=0.015, description="placed within this distance of the packing pose [m]"
    )
    lead_speed: NonNegativeFloat = Field(
        default=0.1,
        description="speed of the target down a rehearsed entry while the object halts [m/s]",
    )
    press: PressConfig = PressConfig()
    stall_time: PositiveFloat = Field(
        default=2.0, description="time without progress after which INSERT or FINE-TUNE has stalled [s]"
    )
    stall_progress: PositiveFloat = Field(default=0.004, description="distance that counts as progress [m]")


@dataclass(frozen=True)
class ChosenPlacement:
    """Where the held object N shall go, and by which way.

    Attributes:
        X_WN: the packing pose.
        collisions: objects that it overlaps.
        entry: the way down to it.
        is_rehearsed: whether that way was tried in simulation; if so, it is followed closely.
    """

    X_WN: Pose
    collisions: tuple[str, ...] = ()
    entry: Entry = field(default_factory=Entry)
    is_rehearsed: bool = False


class GoalMachine(Protocol):
    """What a goal follows: the stages of a placement, or look poses while an object has no pose.

    Attributes:
        stage: the stage, which decides the weights.
        stage_start: time at which it began [s].
    """

    stage: Stage
    stage_start: float

    @property
    def target(self) -> PackingTarget:
        """Where the held object shall go now."""
        ...

    @property
    def placement(self) -> ChosenPlacement:
        """Where it shall go in the end."""
        ...

    @property
    def halt(self) -> float:
        """Time without progress [s]."""
        ...

    def distance(self, p_WN: Array) -> float:
        """Distance [m] from the held object to the end."""
        ...


class StageMachine:
    """Follows one placement from above the container to its place.

    Args:
        scene: the container and the held object.
        config: thresholds.
        placement: where the object shall go.
        time: current time [s].
        X_WN: the held object's current pose; of the headings at which the object looks as the placement
            has it, the nearest to this one is taken.
    """

    def __init__(
        self,
        scene: Scene,
        config: StageConfig,
        placement: ChosenPlacement,
        time: float,
        X_WN: Pose,
    ) -> None:
        self._scene, self._config = scene, config
        self.placement = placement
        self.stage = Stage.PRE_PACK
        self.stage_start = time
        self.is_stalled = False
        self._yaw = nearest_heading(scene.new_object, yaw_of(placement.X_WN.q), yaw_of(X_WN.q))
        self._least, self._progress = np.inf, time
        self._X_WN, self._time = X_WN, time

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects in the container; what is held is the same."""
        self._scene = scene

    @property
    def target(self) -> PackingTarget:
        """Where the held object shall go in this stage."""
        p_WN = self.placement.X_WN.p.copy()
        if self.stage is Stage.FINE_TUNE:
            return PackingTarget(p_WN, self._yaw)
        bottom, half_height = self._bottom, float(self._scene.new_object.half_extents[2])
        entry = self.placement.entry
        axis, aside = entry.at(self._wanted_height(bottom))
        # The entry gives the place of the lower end; half the height along the tilted axis is the middle.
        p_WN[:2] += half_height * axis + aside
        if self.stage is Stage.PRE_PACK:
            p_WN[2] += self._scene.rim + self._config.clearance
            if bottom < self._scene.rim:  # still among the others, as after an attempt that failed
                return self._straight_up(p_WN[2])
            return PackingTarget(p_WN, self._yaw, axis)
        lands = entry.may_land(self._scene.container.height, bottom)
        is_rehearsed = self.placement.is_rehearsed
        press = self._config.press.after(self.halt) if is_rehearsed else 0.0
        return PackingTarget(
            p_WN, self._yaw, axis, entry.over, self.placement.collisions, lands, is_rehearsed, press
        )

    def _wanted_height(self, bottom: float) -> float:
        """Height on the entry that is the target with the lower end at `bottom` [m].

        It is the object's own height, so that the entry waits for the object. While the object halts, the
        target of a rehearsed entry goes on down, as the rehearsal did, and pulls the object after it.
        """
        lead = self._config.lead_speed * self.halt if self.placement.is_rehearsed else 0.0
        return max(bottom - lead, 0.0)

    def _straight_up(self, height: float) -> PackingTarget:
        """The target straight above the object at this height [m], tilted as it is, as it may be wedged."""
        here = self._X_WN
        return PackingTarget(np.array([*here.p[:2], height]), yaw_of(here.q), rotate(here.q, UP)[:2])

    def distance(self, p_WN: Array) -> float:
        """Distance [m] from the held object to the packing pose."""
        return float(np.linalg.norm(p_WN - self.placement.X_WN.p))

    def is_placed(self, p_WN: Array) -> bool:
        """Whether the held object is within the tolerance of the packing pose."""
        return self.stage is Stage.FINE_TUNE and self.distance(p_WN) < self._config.placed_distance

    def update(self, time: float, X_WN: Pose, *, may_insert: bool = True) -> bool:
        """Advance to the next stage if this one is done, and look for a stall.

        Args:
            time: current time [s].
            X_WN: the held object's current pose.
            may_insert: False keeps the object over the container, while another placement is being planned.

        Returns:
            Whether the stage changed.
        """
        before, p_WN = self.stage, X_WN.p
        self._X_WN, self._time = X_WN, time
        if self.stage is Stage.PRE_PACK:
            is_near = np.linalg.norm(p_WN - self.target.p_WN) < self._config.pre_pack_distance
            if is_near and self.is_out and may_insert:
                self._enter(Stage.INSERT, time)
        elif self.stage is Stage.INSERT:
            if self._is_on_base(p_WN):
                self._enter(Stage.FINE_TUNE, time)
            else:
                self._watch_progress(time, float(p_WN[2]))
                self.is_stalled |= self._is_outside()
        else:
            self._watch_progress(time, self.distance(p_WN))
        return self.stage is not before

    @property
    def is_out(self) -> bool:
        """Whether the object's lower end is above all the others and the container."""
        return self._bottom >= self._scene.rim

    @property
    def halt(self) -> float:
        """Time without progress [s]; always 0 in PRE-PACK."""
        return 0.0 if self.stage is Stage.PRE_PACK else self._time - self._progress

    def _enter(self, stage: Stage, time: float) -> None:
        self.stage, self.stage_start = stage, time
        self._least, self._progress, self.is_stalled = np.inf, time, False

    def _is_on_base(self, p_WN: Array) -> bool:
        height = float(p_WN[2]) - float(self.placement.X_WN.p[2])
        return self._is_between_walls(p_WN) and height < self._config.insert_height

    def _is_outside(self) -> bool:
        """Whether the lower end has come down beside the container, from where there is no way in.

        It is that of the object as it is tilted, which may still be above the walls where that of an upright
        object at the same height would not.
        """
        lower_end = self._X_WN.p - float(self._scene.new_object.half_extents[2]) * rotate(self._X_WN.q, UP)
        return lower_end[2] < self._scene.container.height and not self._is_between_walls(lower_end)

    def _is_between_walls(self, p_WN: Array) -> bool:
        container = self._scene.container
        return bool(np.all(p_WN[:2] > container.lower) and np.all(p_WN[:2] < container.upper))

    def _watch_progress(self, time: float, remaining: float) -> None:
        """Note whether what remains has shrunk: the height in INSERT, the distance in FINE-TUNE [m]."""
        if remaining < self._least - self._config.stall_progress:
            self._least, self._progress = remaining, time
        self.is_stalled = time - self._progress > self._config.stall_time

    @property
    def _bottom(self) -> float:
        """Height of the held object's lower end, were it upright [m]."""
        return float(self._X_WN.p[2]) - float(self._scene.new_object.half_extents[2])


def nearest_heading(item: SceneItem, yaw: float, heading: float) -> float:
    """The yaw [rad] nearest to `heading` at which the object looks as it does at `yaw`."""
    if item.symmetry == 0.0:
        return heading
    return float(yaw + item.symmetry * np.round((heading - yaw) / item.symmetry))
