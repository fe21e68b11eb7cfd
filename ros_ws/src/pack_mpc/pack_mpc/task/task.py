"""One packing goal from the first look to its end: looks, placements, stages, stalls, exit conditions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.packing.entry import Entry, WayIn, plan_entry
from pack_core.packing.goals import PackingExitReason
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, from_yaw, yaw_of
from pack_core.states import SceneState
from pack_mpc.target import Stage
from pack_mpc.task.force_record import ForceRecord
from pack_mpc.task.look import LookConfig, LookMachine
from pack_mpc.task.stages import ChosenPlacement, GoalMachine, StageConfig, StageMachine


class TaskConfig(Config):
    """Exit conditions of a goal."""

    timeout: PositiveFloat = Field(default=20.0, description="simulated time that a goal may take [s]")
    force_stop: PositiveFloat = Field(default=math.inf, description="external force that ends the goal [N]")
    avoid_radius: PositiveFloat = Field(
        default=0.02, description="distance that new placements keep from those tried [m]"
    )
    patience: PositiveFloat = Field(
        default=0.5,
        description="time at a halt that relieves the force weight once, as a failed attempt does [s]",
    )
    placement_tries: PositiveInt = Field(
        default=3, description="refused placements in a row that end the goal"
    )
    retries: bool = Field(
        default=True, description="whether an attempt that has stalled is followed by one elsewhere"
    )
    landing_reach: NonNegativeFloat = Field(
        default=0.0,
        description="an object this near to a placement may be landed on: the way down is slow [m]",
    )
    look: LookConfig = LookConfig()
    stages: StageConfig = StageConfig()


@dataclass(frozen=True)
class PackingOutcome:
    """How a goal ended.

    Attributes:
        exit_reason: what ended it.
        success: whether FINE-TUNE was reached.
        message: the reason in words.
        execution_time: time from acceptance to the end [s].
        distance: from the held object to the packing pose at the end [m].
        force_mean: mean magnitude of the external force [N].
        force_peak: largest magnitude of the external force [N].
        placements: how many placements were tried.
    """

    exit_reason: PackingExitReason
    success: bool
    message: str
    execution_time: float
    distance: float
    force_mean: float
    force_peak: float
    placements: int


class PackingTask:
    """Follows a goal: the caller brings measurements and placements, and asks what to do next.

    Args:
        scene: the container and the held object.
        config: exit conditions.
        time: time at which the goal was accepted [s].
        timeout: takes the place of the configured one if it is positive [s].
        lean: tilt of the held object at its entry [rad].
        knows_objects: False lets every entry go straight down, upright, as if the container were empty.

    Attributes:
        tried: the packing poses X_WN that were taken up.
        answers: how often the planner has answered; each request draws other samples.
    """

    def __init__(
        self, scene: Scene, config: TaskConfig, time: float, timeout: float = 0.0, lean: float = 0.0, *,
        knows_objects: bool = True,
    ) -> None:  # fmt: skip
        self._scene, self._config = scene, config
        self._start, self._timeout = time, timeout or config.timeout
        self.lean = lean if knows_objects else 0.0
        self._knows_objects = knows_objects
        self._look: LookMachine | None = None
        self._stages: StageMachine | None = None
        self.tried: list[Pose] = []
        self._has_placement = False
        self.outcome: PackingOutcome | None = None
        self._has_succeeded, self._refusals = False, 0
        self.answers = 0
        self._forces = ForceRecord()
        self.distance = 0.0

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects in the container, or where that is now; what is held is the same."""
        self._scene = scene
        if self._look is not None:
            self._look.change_scene(scene)
        if self._stages is not None:
            self._stages.change_scene(scene)

    @property
    def machine(self) -> GoalMachine | None:
        """What is followed: look poses until every object has a pose, then stages; None at first."""
        return self._stages or self._look

    @property
    def has_seen_all(self) -> bool:
        """Whether every object has had a pose, so that from now on each must have one."""
        return self._stages is not None

    @property
    def is_looking(self) -> bool:
        """Whether the goal looks for objects without a pose."""
        return self._look is not None and self._stages is None

    @property
    def unseen(self) -> tuple[str, ...]:
        """Names of the objects that the goal looked for last."""
        return () if self._look is None else self._look.unseen

    def elapsed(self, time: float) -> float:
        """Time since the goal was accepted [s]."""
        return time - self._start

    @property
    def needs_placement(self) -> bool:
        """Whether to plan a placement now: before the first attempt, and from the moment an attempt fails.

        After a failure the held object is still among the others then, but its way out hardly moves them:
        docs/journal/2026-11-26_ways_into_a_full_container.md.
        """
        return not self._has_placement

    @property
    def avoid(self) -> list[Array]:
        """Positions `(3,)` [m] of the placements that have been tried."""
        return [X_WN.p for X_WN in self.tried]

    def place(
        self,
        X_WN: Pose,
        collisions: tuple[str, ...],
        way: WayIn,
        scene: SceneState,
        is_rehearsed: bool = False,
    ) -> None:
        """Take up a placement that was planned.

        Args:
            X_WN: the packing pose.
            collisions: objects that it overlaps.
            way: how the object is to enter.
            scene: where the objects are now.
            is_rehearsed: whether the way down was tried in simulation.
        """
        entry = (
            plan_entry(self._scene, X_WN, collisions, scene.poses(), way, self._config.landing_reach)
            if self._knows_objects
            else Entry()
        )
        placement = ChosenPlacement(X_WN, collisions, entry, is_rehearsed)
        self._follow(placement, scene.time, scene.objects[self._scene.new_object.name].X_WO)
        self.tried.append(X_WN)
        self._has_placement, self._refusals = True, 0
        self.answers += 1

    def refuse(self, time: float, reason: str) -> None:
        """Note that the planner found no placement; some refusals in a row end the goal."""
        self._refusals += 1
        self.answers += 1
        if self._refusals >= self._config.placement_tries:
            self.finish(PackingExitReason.NO_PLACEMENT, time, reason)

    @property
    def avoid_radius(self) -> float:
        """Distance that new placements keep from those tried [m]."""
        return self._config.avoid_radius

    @property
    def reliefs(self) -> float:
        """Force-weight relief: how many times the force's weight is reduced, whole or in part.

        Each failed attempt counts 1, and a halt counts its time over `patience`. On the way down an entry
        that was not rehearsed, a halt does not count: other objects may be in its way.
        """
        failures, machine = max(len(self.tried) - 1, 0), self.machine
        if machine is None or not (machine.placement.is_rehearsed or machine.stage is Stage.FINE_TUNE):
            return float(failures)
        return failures + machine.halt / self._config.patience

    def note_forces(self, time: float, forces: Array) -> None:
        """Note the external force, and end the goal if the filtered force is above the force stop.

        Args:
            time: current time [s].
            forces: since the last call `(n, 3)` [N], at the rate of /wrench.
        """
        peak, limit = self._forces.note(forces), self._config.force_stop
        if peak > limit:
            self.finish(PackingExitReason.FORCE, time, f"external force {peak:.1f} N above {limit:.1f} N")

    def update(self, time: float, X_WN: Pose, unseen: tuple[str, ...] = ()) -> bool:
        """Advance the goal with the held object at X_WN.

        Args:
            time: current time [s].
            X_WN: pose of the held object.
            unseen: names of the objects without a pose; they are looked for before the first placement.

        Returns:
            Whether the stage or the target changed.
        """
        if unseen and not self.has_seen_all:
            return self._look_for(unseen, time, X_WN)
        changed, machine = False, self._stages
        if machine is None:
            changed, machine = self._look is not None, self._follow(self._middle(X_WN), time, X_WN)
        changed |= machine.update(time, X_WN, may_insert=self._has_placement)
        self.distance = machine.distance(X_WN.p)
        self._has_succeeded |= machine.stage is Stage.FINE_TUNE
        if machine.is_placed(X_WN.p):
            self.finish(
                PackingExitReason.PLACED, time, f"within {self._config.stages.placed_distance * 1e3:.0f} mm"
            )
        elif machine.is_stalled and self._config.retries:
            changed = self._retreat(machine, time, X_WN)
        self.expire(time)
        return changed

    def expire(self, time: float) -> None:
        """End the goal if its time is up."""
        if self.elapsed(time) > self._timeout:
            self.finish(PackingExitReason.TIMEOUT, time, self._where())

    def finish(self, reason: PackingExitReason, time: float, message: str) -> None:
        """End the goal; the first reason stands."""
        if self.outcome is not None:
            return
        self.outcome = PackingOutcome(
            reason, self._has_succeeded, message, self.elapsed(time), self.distance,
            self._forces.mean, self._forces.peak, len(self.tried),
        )  # fmt: skip

    def _look_for(self, unseen: tuple[str, ...], time: float, X_WN: Pose) -> bool:
        """Look for objects without a pose; the goal ends once all look poses have been tried."""
        if self._look is None:
            self._look = LookMachine(self._scene, self._config.look, time, X_WN)
        look = self._look
        changed = look.update(time, X_WN, unseen)
        self.distance = look.distance(X_WN.p)
        if look.is_exhausted:
            self.finish(PackingExitReason.NO_PLACEMENT, time, look.report)
        self.expire(time)
        return changed

    def _retreat(self, machine: StageMachine, time: float, X_WN: Pose) -> bool:
        """Go back above the container and ask for another placement."""
        self._follow(machine.placement, time, X_WN)
        self._has_placement = False
        return True

    def _middle(self, X_WN: Pose) -> ChosenPlacement:
        """The middle of the container: the arm goes above it while the first placement is being planned."""
        x, y = self._scene.container.centre
        half_height = float(self._scene.new_object.half_extents[2])
        return ChosenPlacement(Pose(np.array([x, y, half_height]), from_yaw(yaw_of(X_WN.q))))

    def _follow(self, placement: ChosenPlacement, time: float, X_WN: Pose) -> StageMachine:
        self._stages = machine = StageMachine(self._scene, self._config.stages, placement, time, X_WN)
        return machine

    def _where(self) -> str:
        stage = self.machine.stage.value if self.machine else "waiting for a placement"
        return f"after {self._timeout:.1f} s in stage {stage}, {len(self.tried)} placements tried"
