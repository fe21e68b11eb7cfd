"""Draws docs/images/packing_depth.png: `python tools/depth_pictures.py`. It takes some seconds.

Each row is a scene for tuning: as the three depth cameras see it, as a look models it, and as it is.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pack_core.packing.free_space import footprint
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Container
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.paths import project_root
from pack_core.rotations import Array, Pose
from pack_lockstep.packing.lockstep import LockstepCell
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_sim.packing.depth_cameras import DepthCameraSystem
from pack_sim.packing.scene_generator import generate_scene

OUTPUT = project_root() / "docs/images/packing_depth.png"
SCENES = (("unknown", 28), ("unknown_household", 103), ("unknown_household", 219))
"""Preset and seed of each row: two objects of one height, shapes of all kinds, and a look that is wrong."""
TITLES = (
    "as one camera sees it",
    "as the second does",
    "as the third does",
    "as modelled, ± 2 deviations",
    "as it is",
)
NEAR, FAR = 0.45, 0.85
"""Depths at the ends of the colours [m]."""

Placed = Sequence[tuple[ObjectModel, Pose]]


def main() -> None:
    """Draw a row for each scene."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    figure = Figure(figsize=(13.5, 2.5 * len(SCENES)), layout="constrained")
    rows = figure.subplots(len(SCENES), len(TITLES))
    for row, (preset, seed) in zip(rows, SCENES, strict=True):
        draw_scene(row, preset, seed)
    for axes, title in zip(rows[0], TITLES, strict=True):
        axes.set_title(title, fontsize=11)
    figure.savefig(OUTPUT, dpi=80)


def draw_scene(row: Sequence[Axes], preset: str, seed: int) -> None:
    """Draw the images, what a look makes of them, and what is there."""
    given = load_preset(preset)
    cell = given.packing_cell()
    lockstep = LockstepCell(cell, generate_scene(seed, cell), lockstep_config(given), seed, lambda *_: None)
    lockstep.settle()
    for axes, image in zip(row, images(lockstep, seed), strict=False):
        axes.imshow(np.where(image > 0.0, image, np.nan), cmap="viridis_r", vmin=NEAR, vmax=FAR)
        axes.set(xticks=[], yticks=[])
    row[0].set_ylabel(f"{preset}, seed {seed}")
    seen, truth = lockstep.seen(), lockstep.simulator.truth().poses()
    modelled = [(item, seen.poses[item.name]) for item in seen.scene.objects]
    true = [(item, truth[item.name]) for item in lockstep.simulator.scene.objects]
    for axes, placed in zip(row[3:], (modelled, true), strict=True):
        draw_from_above(axes, placed, cell.scene.container)
    assert isinstance(lockstep.estimator, DepthEstimator)
    for item, X_WO in modelled:
        draw_deviations(row[3], X_WO, lockstep.estimator.deviations[item.name])


def images(lockstep: LockstepCell, seed: int) -> Array:
    """What the cameras of the seed measure now `(cameras, height, width)` [m]."""
    simulator = lockstep.simulator
    cameras = DepthCameraSystem(simulator.cell.depth, np.random.default_rng([seed, 2]))
    return cameras.capture(simulator.model, simulator.data, simulator.time).images


def draw_from_above(axes: Axes, placed: Placed, container: Container) -> None:
    """Outlines, with what they are and how high [mm]."""
    colours = mpl.colormaps["tab10"]
    for i, (item, X_WO) in enumerate(placed):
        axes.fill(*shapely.get_coordinates(footprint(item, X_WO)).T, color=colours(i % 10), alpha=0.6)
        x, y, _ = X_WO.p
        kind = f"{item.shape}\n{2e3 * item.half_extents[2]:.0f}"
        axes.text(x, y, kind, ha="center", va="center", fontsize=7)
    walls = shapely.box(*container.lower, *container.upper)
    axes.plot(*shapely.get_coordinates(walls).T, color="black", lw=2)
    axes.set(aspect="equal", xticks=[], yticks=[])


def draw_deviations(axes: Axes, X_WO: Pose, known: SeenDeviations) -> None:
    """Two standard deviations of where a middle is, along the object's own axes."""
    for sigma, along in zip(known.position[:2], np.eye(3), strict=False):
        ends = X_WO.apply(2.0 * sigma * np.array([-along, along]))
        axes.plot(*ends[:, :2].T, color="black", lw=1.2)


if __name__ == "__main__":
    main()
