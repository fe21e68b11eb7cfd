"""Hand-made runs whose measures are known in closed form."""

from dataclasses import replace
from functools import cache
from typing import Any

import mujoco
import numpy as np
from scipy.optimize import least_squares

from pack_core import rotations
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.rotations import IDENTITY, Array
from pack_core.states import Source
from pack_evaluation.packing.run import Iterations, Run
from pack_evaluation.track import Track

START, END = 2.0, 6.0
TARGET = np.array([0.5, 0.0, 0.09])
"""Where the held object stands on the floor, in the middle of the container."""


@cache
def holding_joints() -> Array:
    """Joint positions `(7,)` [rad] at which the arm holds the object at `TARGET`, upright."""
    cell = packing_cell()
    model = build_model(cell.scene, cell, timestep=0.01, arm=ArmRole.GUIDED, held=HeldRole.RIGID)
    data, joints = mujoco.MjData(model), cell.robot.arm.joints
    rows = [model.joint(name).qposadr[0] for name in joints]

    def error(q: Array) -> Array:
        data.qpos[rows] = q
        mujoco.mj_kinematics(model, data)
        body = data.body(cell.scene.new_object.name)
        return np.concatenate([body.xpos - TARGET, rotations.log(body.xquat)])

    found = least_squares(error, cell.robot.home, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert np.abs(found.fun).max() < 1e-9
    return np.asarray(found.x)


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
    """A run in which nothing moves and the held object is where it should be, but for the changes.

    The other objects stand on the table beside the container, apart from one another.
    """
    scene = packing_cell().scene
    places = {
        item.name: np.array([0.3 + 0.15 * i, 0.4, item.half_extents[2]])
        for i, item in enumerate(scene.objects)
    }
    places[scene.new_object.name] = TARGET
    times = np.linspace(0.0, 8.0, 801)
    run = Run(
        scene=scene, start=START, end=END, iterations=iterations(("PRE_PACK", "INSERT", "FINE_TUNE")),
        truth={name: still(p) for name, p in places.items()},
        estimate={name: still(p, Source.MOCAP) for name, p in places.items()},
        joint_times=times, joints=np.tile(holding_joints(), (times.size, 1)),
        force_times=times, force=np.zeros(times.size), real_time_factors=np.array([0.4, 0.6]),
    )  # fmt: skip
    return replace(run, **changes)
