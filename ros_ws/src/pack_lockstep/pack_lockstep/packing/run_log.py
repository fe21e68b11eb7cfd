"""Records a run in lockstep as a `Run`, the form in which recordings are evaluated."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np

from pack_core.joints import JointSample
from pack_core.packing.scene import Scene
from pack_core.packing.settled_sample import SettledSample
from pack_core.packing.topics import TRUTH_RATE
from pack_core.states import SceneState
from pack_core.topics import steps_between
from pack_evaluation.packing.run import Iterations, Run
from pack_evaluation.track import to_tracks
from pack_mpc.controller import ControlPlan
from pack_mpc.task.stages import ChosenPlacement
from pack_mpc.task.task import PackingOutcome, PackingTask
from pack_perception.mocap.physics_estimator import PhysicsEstimator
from pack_planner.placement.placement_result import SHOWN, PlannedPlacement
from pack_sim.packing.simulator import Simulator


@dataclass(frozen=True)
class _Iteration:
    time: float
    elapsed: float
    stage: str
    distance: float
    placements: int
    placement: ChosenPlacement
    plan: ControlPlan


class PackingRunLog:
    """Collects samples during a run; `to_run` turns them into arrays."""

    def __init__(self) -> None:
        self._steps = 0
        self._forces: list[tuple[float, float]] = []
        self._joints: list[JointSample] = []
        self._truth: list[SceneState] = []
        self._estimate: list[SceneState] = []
        self._iterations: list[_Iteration] = []
        self._samples: tuple[SettledSample, ...] = ()

    def sense(self, simulator: Simulator, estimator: PhysicsEstimator) -> None:
        """Record the cell after a step of its physics: forces always, the rest at the rate of /sim/truth."""
        self._steps += 1
        force, _ = simulator.external_wrench()
        self._forces.append((simulator.time, float(np.linalg.norm(force))))
        if self._steps % steps_between(TRUTH_RATE, simulator.config.timestep):
            return
        self._joints.append(simulator.joints())
        self._truth.append(simulator.truth())
        if not math.isnan(estimator.time):
            self._estimate.append(estimator.state(estimator.time))

    def place(self, placement: PlannedPlacement) -> None:
        """Record the settled samples of a goal's first placement."""
        self._samples = self._samples or placement.samples.spread(SHOWN)

    def iterate(self, task: PackingTask, time: float, plan: ControlPlan) -> None:
        """Record an iteration of the controller that planned from the state at `time` [s]."""
        machine = task.machine
        assert machine is not None
        self._iterations.append(
            _Iteration(
                time, task.elapsed(time), machine.stage.name, task.distance, len(task.tried),
                machine.placement, plan,
            )
        )  # fmt: skip

    def to_run(
        self, scene: Scene, start: float, outcome: PackingOutcome, release_reason: str, arm: str
    ) -> Run:
        """The run of a goal that was accepted at `start` [s] and has ended; `arm` names the arm."""
        force_times, force = np.array(self._forces).T
        return Run(
            scene=scene.description(), start=start, end=start + outcome.execution_time,
            iterations=self._to_iterations(),
            truth=to_tracks(self._truth), estimate=to_tracks(self._estimate),
            joint_times=np.array([sample.time for sample in self._joints]),
            joints=np.array([sample.q for sample in self._joints]), force_times=force_times, force=force,
            release_reason=release_reason, arm=arm, samples=self._samples,
            outcome={**asdict(outcome), "exit_reason": outcome.exit_reason.value},
        )  # fmt: skip

    def _to_iterations(self) -> Iterations:
        rows = self._iterations
        columns = [(row.time, row.elapsed, row.distance, row.placements) for row in rows]
        times, elapsed, distance, placements = np.array(columns, dtype=float).reshape(-1, 4).T
        return Iterations(
            times=times, elapsed=elapsed, stages=tuple(row.stage for row in rows), distance=distance,
            cost=np.array([row.plan.solution.cost for row in rows], dtype=float),
            ms=np.array([row.plan.iteration_ms for row in rows], dtype=float), placements=placements,
            p_WT=np.array([row.placement.X_WN.p for row in rows]).reshape(-1, 3),
            q_WT=np.array([row.placement.X_WN.q for row in rows]).reshape(-1, 4),
            collisions=tuple(row.placement.collisions for row in rows),
        )  # fmt: skip
