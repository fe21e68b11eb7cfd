"""Hand-made runs whose measures are known in closed form."""

from dataclasses import replace
from typing import Any

import numpy as np

from pack_core.packing.cell import packing_cell
from pack_core.rotations import IDENTITY, Array
from pack_core.states import Source
from pack_evaluation.packing.run import Iterations, Run
from pack_evaluation.track import Track

START, END = 2.0, 6.0
TARGET = np.array([0.5, 0.0, 0.09])


def still(p: Array, source: Source = Source.TRUTH) -> Track:
    """A track that stays at `p` from 0 to 8 s, sampled at 100 Hz."""
    times = np.linspace(0.0, 8.0, 801)
    rows = np.ones((times.size, 1))
    return Track(times, rows * p, rows * IDENTITY, np.full(times.size, source, dtype=np.uint8))


def iterations(stages: tuple[str, ...]) -> Iterations:
    """Iterations evenly spread over the goal, one for each stage given."""
    n = len(stages)
    elapsed = np.linspace(0.5, END - START, n)
    rows = np.ones((n, 1))
    return Iterations(
        times=START + elapsed, elapsed=elapsed, stages=stages, distance=np.linspace(0.3, 0.01, n),
        cost=np.ones(n), ms=10.0 * np.arange(1, n + 1), placements=np.ones(n),
        p_WT=rows * TARGET, q_WT=rows * IDENTITY, collisions=((),) * n,
    )  # fmt: skip


def make_run(**changes: Any) -> Run:
    """A run in which nothing moves and the held object is where it should be, but for the changes."""
    scene = packing_cell().scene
    places = {name: np.array([0.4 + 0.05 * i, 0.0, 0.06]) for i, name in enumerate(scene.names)}
    places[scene.new_object.name] = TARGET
    times = np.linspace(0.0, 8.0, 801)
    run = Run(
        scene=scene, start=START, end=END, iterations=iterations(("PRE_PACK", "INSERT", "FINE_TUNE")),
        truth={name: still(p) for name, p in places.items()},
        estimate={name: still(p, Source.MOCAP) for name, p in places.items()},
        joint_times=times, joints=np.zeros((times.size, 7)),
        force_times=times, force=np.zeros(times.size), real_time_factors=np.array([0.4, 0.6]),
    )  # fmt: skip
    return replace(run, **changes)
