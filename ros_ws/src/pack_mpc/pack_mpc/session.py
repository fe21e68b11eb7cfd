"""A goal in progress: the task and its controller, one observation at a time."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import NEXT_GOAL, Changeable, Config
from pack_core.errors import MessageError
from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import PackingExitReason, PackingMethod
from pack_core.packing.scene import Scene
from pack_core.states import SceneState
from pack_mpc.controller import ControllerConfig, ControlPlan, PackingController
from pack_mpc.cost.weights import WeightFactors, load_weights
from pack_mpc.held_watch import HeldWatch, arm_chain
from pack_mpc.load_estimate import LoadConfig
from pack_mpc.observation import PackingObservation, unseen_of, with_parked
from pack_mpc.task.task import PackingTask, TaskConfig


class SessionConfig(Config):
    """Parameters of a goal and its controller."""

    changeable: ClassVar[Changeable] = NEXT_GOAL

    weights: str = Field(default="tuned", description="weights of the cost: a file of config/weights")
    weight_factors: WeightFactors = WeightFactors()
    controller: ControllerConfig = ControllerConfig()
    task: TaskConfig = TaskConfig()
    load: LoadConfig = LoadConfig()
    blind_time: PositiveFloat = Field(
        default=1.0,
        description="the arm holds when the cameras have seen no object at all for so long, but in LOOK [s]",
    )


class PackingSession:
    """Carries a goal from acceptance to its outcome.

    Args:
        scene: shapes, sizes and masses.
        cell: the cell's physical facts.
        config: parameters.
        method: PackItIn or a baseline.
        time: time at which the goal was accepted [s].
        timeout: takes the place of the configured one if it is positive [s].
    """

    def __init__(
        self,
        scene: Scene,
        cell: PackingCell,
        config: SessionConfig,
        method: PackingMethod,
        time: float,
        timeout: float = 0.0,
    ) -> None:
        self.scene, self.method, self._config = scene, method, config
        weights = load_weights(config.weights).times(config.weight_factors)
        self.task = PackingTask(
            scene, config.task, time, timeout, weights.lean, knows_objects=method.knows_objects
        )
        self.controller = PackingController(self._modelled(scene), cell, weights, config.controller)
        self._watch = HeldWatch(arm_chain(cell), scene, config.load)
        self.iterations_ms: list[float] = []

    def _modelled(self, scene: Scene) -> Scene:
        """The scene with the objects that the method takes into account."""
        return scene if self.method.knows_objects else scene.model_copy(update={"objects": []})

    def follow(self, scene: Scene) -> bool:
        """Go on with what is described now: objects that were seen meanwhile, or seen better, and where from.

        Returns:
            Whether anything has changed. A scene in which something else is held, or that lacks an object, is
            not that of this goal: nothing vanishes.
        """
        is_same_goal = scene.new_object.name == self.scene.new_object.name and not scene.is_handed_over
        is_same_goal &= set(self.scene.names) <= set(scene.names)
        now = {"objects": scene.objects, "container": scene.container}
        scene = self.scene.model_copy(update=now)
        if not is_same_goal or scene == self.scene:
            return False
        self.controller.change_scene(self._modelled(scene))
        self.task.change_scene(scene)
        self._watch.change_scene(scene)
        self.scene = scene  # the last: a scene that cannot be modelled is tried again, and told of again
        return True

    def needs_placement(self, scene: SceneState) -> bool:
        """Whether to plan a placement now: the task has none, and every object of the scene has a pose."""
        return self.task.needs_placement and not unseen_of(self.scene, scene)

    def step(self, seen: PackingObservation, latency: float) -> ControlPlan | None:
        """Advance the task and plan once.

        Args:
            seen: the newest observation.
            latency: time from the observation until the plan will be in force [s].

        Returns:
            The plan; None once the goal has ended.

        Raises:
            MessageError: the scene lacks the held object, or objects that it had, as when perception has
                begun anew.
        """
        task, time, objects = self.task, seen.joints.time, seen.scene.objects
        held, unseen = self.scene.new_object.name, unseen_of(self.scene, seen.scene)
        lost = unseen if task.has_seen_all else ()
        if held not in objects or lost:
            raise MessageError(f"the newest scene lacks {', '.join(lost or (held,))}")
        X_WN = objects[held].X_WO
        task.note_forces(time, seen.forces)
        if not seen.is_held:
            task.finish(PackingExitReason.DETACHED, time, "the pump lost the object")
        elif (fault := self._watch.observe(seen)) is not None:
            task.finish(fault.reason, time, fault.message)
        if task.update(time, X_WN, unseen):
            self.controller.change_cost()
        machine = task.machine
        if task.outcome is not None or machine is None:
            return None
        scene = with_parked(self.scene, seen.scene) if task.is_looking else seen.scene
        plan = self.controller.plan(
            seen.joints, scene, machine.stage, machine.target, time - machine.stage_start, latency,
            task.reliefs,
        )  # fmt: skip
        self.iterations_ms.append(plan.iteration_ms)
        return plan

    @property
    def blind_time(self) -> float:
        """For how long the arm goes on when the cameras see nothing [s]: LOOK is what lets them see."""
        return np.inf if self.task.is_looking else self._config.blind_time

    @property
    def iteration_ms(self) -> float:
        """Median wall-clock time of the iterations so far [ms]."""
        return float(np.median(self.iterations_ms)) if self.iterations_ms else 0.0
