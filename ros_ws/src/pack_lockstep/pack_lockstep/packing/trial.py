"""One scene of the packing benchmark, from its seed to its run."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

from pack_core.errors import PackError
from pack_core.packing.scene import Scene
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.study.summary import FAILURE_METRICS
from pack_evaluation.packing.study.trial import PackingTrial
from pack_lockstep.packing.lockstep import Lockstep
from pack_lockstep.packing.settings import PackingSetup, SceneJob
from pack_sim.packing.scene_generator import generate_scene


@dataclass(frozen=True)
class SceneResult:
    """A scene, its run, and the wall clock time that the run took [s]."""

    job: SceneJob
    scene: Scene
    run: Run
    wall_time: float


def run_scene(setup: PackingSetup, job: SceneJob) -> SceneResult:
    """Run one scene to its outcome; the run depends on nothing but the arguments.

    Raises:
        PackError: the scene cannot be generated.
    """
    started = time.perf_counter()
    try:
        scene = job.scene or generate_scene(job.seed, setup.cell, blocked=setup.settings.blocked)
    except PackError as error:
        raise PackError(f"{job.name}: {error}") from error
    lockstep = Lockstep(setup.cell, scene, setup.config, setup.settings.method, job.seed)
    lockstep.run()
    return SceneResult(job, scene, lockstep.recorded(), time.perf_counter() - started)


def trial_line(result: SceneResult, trial: PackingTrial, threads: int) -> dict[str, Any]:
    """The trial's line in the file of results; times in [s], forces in [N], shares in [%]."""
    m = trial.measures
    return {
        "name": result.job.name, "seed": result.job.seed, "success": m.success,
        "exit_reason": m.exit_reason.value, "message": trial.message, "execution_time_s": m.execution_time,
        "distance_cm": 1e2 * m.distance, "contained": m.is_contained, "protrusion_mm": 1e3 * m.protrusion,
        "tilt_deg": math.degrees(m.tilt), "chatter_percent": 1e2 * m.chatter,
        "force_mean_N": m.force_mean, "force_p95_N": m.force_p95,
        "iterations": m.iterations, "iteration_ms": m.iteration_ms, "displacement_cm": 1e2 * m.displacement,
        **{name: metric(m) for name, metric in FAILURE_METRICS.items()},
        "threads": threads, "wall_time_s": result.wall_time,
    }  # fmt: skip
