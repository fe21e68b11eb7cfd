"""Of which objects a look with depth cameras knows little, and how much of them the cameras see.

    PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.hidden_objects --seeds 1001 1010 1011

A line for each scene: every object of which nothing that was seen covers half, with the largest overlap of
outlines, and with the share of its pixels that other objects and the arm leave visible, in all cameras
together. At last what was seen and covers half of no object.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterable

import mujoco
import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_evaluation.packing.seen_objects import FOUND
from pack_lockstep.packing.lockstep import LockstepCell
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_sim.packing.depth_cameras import CameraRays
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator


def main() -> None:
    """Look into each scene."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--preset", default="unknown_household")
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    options = parser.parse_args()
    for seed in options.seeds:
        sys.stdout.write(f"{line(options.preset, seed)}\n")
        sys.stdout.flush()


def line(preset: str, seed: int) -> str:
    """What a look into a scene misses, in words."""
    given = load_preset(preset)
    cell = given.packing_cell()
    lockstep = LockstepCell(cell, generate_scene(seed, cell), lockstep_config(given), seed, lambda *_: None)
    lockstep.settle()
    seen, truth = lockstep.seen(), lockstep.simulator.truth().poses()
    true = {item.name: footprint(item, truth[item.name]) for item in lockstep.simulator.scene.objects}
    known = {item.name: footprint(item, seen.poses[item.name]) for item in seen.scene.objects}
    missed = [
        f"{name}: overlap {best:.2f}, {visible_share(lockstep.simulator, name):.0%} seen"
        for name, outline in true.items()
        if (best := largest_overlap(outline, known.values())) < FOUND
    ]
    beside = [name for name, outline in known.items() if largest_overlap(outline, true.values()) < FOUND]
    counts = f"{seed}: {len(true)} objects, {len(known)} seen"
    return f"{counts}; {'; '.join(missed) or 'none missed'}; of none: {', '.join(beside) or 'nothing'}"


def largest_overlap(outline: shapely.Polygon, others: Iterable[shapely.Polygon]) -> float:
    """Of an outline with any of the others: the area of both over that of either."""
    shares = [outline.intersection(o).area / outline.union(o).area for o in others]
    return max(shares, default=0.0)


def visible_share(simulator: Simulator, name: str) -> float:
    """Share of an object's pixels, in all cameras, that nothing else hides."""
    model, alone = simulator.model, mujoco.MjData(simulator.model)
    alone.qpos[:] = simulator.data.qpos
    free = {model.joint(number).name for number in range(model.njnt)}
    for other in {*simulator.scene.names, simulator.scene.new_object.name} & free - {name}:
        alone.qpos[model.joint(other).qposadr[0] + 2] -= 5.0  # far below the table
    mujoco.mj_kinematics(model, alone)
    return pixels(simulator, simulator.data)[name] / max(pixels(simulator, alone)[name], 1)


def pixels(simulator: Simulator, data: mujoco.MjData) -> Counter[str]:
    """Number of pixels of all cameras that meet each body."""
    found = Counter[str]()
    for camera in simulator.cell.depth.cameras():
        geoms = CameraRays(camera).cast(simulator.model, data).geoms
        for geom, count in zip(*np.unique(geoms[geoms >= 0], return_counts=True), strict=True):
            found[simulator.model.body(simulator.model.geom_bodyid[geom]).name] += int(count)
    return found


if __name__ == "__main__":
    main()
