"""Many scenes in lockstep, and what they amount to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass

import numpy as np

from pack_bringup.lockstep import Lockstep, lockstep_config
from pack_core.cells.packing import packing_cell
from pack_mpc.session import Method
from pack_sim.packing.scene_generator import generate_scene


@dataclass(frozen=True)
class Trial:
    """One scene: how it ended, its measures, and every iteration's time [ms of wall clock]."""

    seed: int
    success: bool
    exit_reason: str
    execution_time_s: float
    distance_cm: float
    force_mean_N: float
    force_peak_N: float
    placements: int
    iterations_ms: list[float]


def run_trials(seeds: range, method: Method, weights: str | None = None) -> Iterator[Trial]:
    """Run a scene for each seed, with the nodes' configuration.

    Args:
        seeds: of scene, noise and placements.
        method: PackItIn or a baseline.
        weights: a set of config/weights; None for that of config/nodes/mpc.yaml.
    """
    cell, config = packing_cell(), lockstep_config(weights)
    for seed in seeds:
        lockstep = Lockstep(cell, generate_scene(seed, cell), config, method, seed)
        outcome = lockstep.run()
        yield Trial(
            seed, outcome.success, outcome.exit_reason.value, outcome.execution_time, 100 * outcome.distance,
            outcome.force_mean, outcome.force_peak, outcome.placements, lockstep.session.iterations_ms,
        )  # fmt: skip


def summarize(trials: list[Trial]) -> dict[str, object]:
    """Counts, and the spread of each measure over the scenes."""
    exits = [trial.exit_reason for trial in trials]
    return {
        "scenes": len(trials),
        "success": sum(trial.success for trial in trials),
        "execution_time_s": spread([trial.execution_time_s for trial in trials]),
        "distance_cm": spread([trial.distance_cm for trial in trials]),
        "contact_force_N": spread([trial.force_mean_N for trial in trials]),
        "peak_force_N": spread([trial.force_peak_N for trial in trials]),
        "iteration_ms": spread([ms for trial in trials for ms in trial.iterations_ms]),
        "exits": {reason: exits.count(reason) for reason in sorted(set(exits))},
        "trials": [{k: v for k, v in asdict(trial).items() if k != "iterations_ms"} for trial in trials],
    }


def spread(values: list[float]) -> dict[str, float]:
    """Mean, standard deviation, median and 95th percentile; NaN for no values."""
    array = np.array(values or [np.nan])
    return {
        "mean": float(array.mean()),
        "std": float(array.std()),
        "median": float(np.median(array)),
        "p95": float(np.percentile(array, 95)),
    }
