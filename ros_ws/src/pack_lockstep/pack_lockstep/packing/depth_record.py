"""How right perception by depth images was: what was seen of which object, and how far off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.optimize import linear_sum_assignment

from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, rotate, yaw_of
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track
from pack_perception.mocap.physics_estimator import PhysicsEstimator
from pack_sim.packing.simulator import Simulator

FOUND = 0.5
"""Overlap of outlines from which something that was seen stands for an object."""


@dataclass(frozen=True)
class SeenObject:
    """What was seen of an object before the goal.

    Attributes:
        name: what perception calls it.
        has_heading: whether it is seen as a shape of its kind that has a heading; a hull has none.
        overlap: of the outlines as seen and as true, intersection over union.
        sizes: lengths as seen less true ones: short and long side of its outline, and height `(3,)` [m].
    """

    name: str
    has_heading: bool
    overlap: float
    sizes: tuple[float, float, float]


@dataclass(frozen=True)
class SeenScene:
    """What was seen before the goal.

    Attributes:
        count: number of objects that perception knew of.
        objects: what was found, by the true object's name.
    """

    count: int
    objects: Mapping[str, SeenObject]


@dataclass(frozen=True)
class Quantiles:
    """Median, 95th percentile and largest of absolute errors; nan without any."""

    median: float
    p95: float
    max: float

    @classmethod
    def of(cls, errors: Array) -> Quantiles:
        """Those of `errors`, of any shape."""
        if not np.size(errors):
            return cls(*[float("nan")] * 3)
        return cls(*np.quantile(np.abs(errors), [0.5, 0.95, 1.0]).tolist())


@dataclass(frozen=True)
class PerceptionErrors:
    """Errors of perception by depth images in one run.

    Attributes:
        objects: number of objects in the container.
        seen: number of objects that perception knew of before the goal.
        found: objects of which one of these covers most.
        position_mm: of all found objects, over the whole goal.
        angle_deg: of their axes and headings, less symmetries; headings of the same shapes alone.
        size_mm: of lengths and heights of what was seen before the goal.
    """

    objects: int
    seen: int
    found: int
    position_mm: Quantiles
    angle_deg: Quantiles
    size_mm: Quantiles


def seen_objects(known: Scene, estimator: PhysicsEstimator, simulator: Simulator) -> SeenScene:
    """Match what perception knows to the true objects, by their outlines."""
    estimate, truth = estimator.state(estimator.time).poses(), simulator.truth().poses()
    names = [name for name in known.names if name in estimate]
    seen = [footprint(known.model_of(name), estimate[name]) for name in names]
    true = [footprint(item, truth[item.name]) for item in simulator.scene.objects]
    overlaps = np.array([[s.intersection(t).area / s.union(t).area for t in true] for s in seen])
    found = {}
    for i, j in zip(*linear_sum_assignment(-overlaps.reshape(len(seen), len(true))), strict=True):
        if overlaps[i, j] > FOUND:
            item, model = simulator.scene.objects[j], known.model_of(names[i])
            height = 2.0 * float(model.half_extents[2] - item.half_extents[2])
            sides = _sides(seen[i]) - _sides(true[j])
            alike = type(model) is type(item) and not isinstance(model, ConvexMesh)
            found[item.name] = SeenObject(names[i], alike, float(overlaps[i, j]), (*sides.tolist(), height))
    return SeenScene(len(names), found)


def with_true_names(run: Run, seen: SeenScene, simulator: Simulator) -> Run:
    """The run of unknown objects with the true scene, in which what was seen has the true objects' names."""
    names = {item.name: true for true, item in seen.objects.items()}
    collisions = tuple(tuple(names.get(name, name) for name in row) for row in run.iterations.collisions)
    return replace(
        run, scene=simulator.scene.description(), samples=(),
        estimate={names.get(name, name): track for name, track in run.estimate.items()},
        iterations=replace(run.iterations, collisions=collisions),
    )  # fmt: skip


def perception_errors(run: Run, seen: SeenScene, simulator: Simulator) -> PerceptionErrors:
    """The errors in a run whose objects have their true names."""
    positions, angles = [], []
    for name in seen.objects:
        estimate = run.estimate[name].between(run.start, run.end)
        truth = run.truth[name].at(estimate.times)
        positions.append(estimate.distance_to(truth.p))
        angles.append(_angles(_symmetry(simulator.scene.model_of(name), seen.objects[name]), estimate, truth))
    sizes = [item.sizes for item in seen.objects.values()]
    return PerceptionErrors(
        len(simulator.scene.objects), seen.count, len(seen.objects),
        Quantiles.of(1e3 * np.concatenate([*positions, []])),
        Quantiles.of(np.rad2deg(np.concatenate([*angles, []]))), Quantiles.of(1e3 * np.array(sizes)),
    )  # fmt: skip


def _sides(outline: shapely.Polygon) -> Array:
    """Short and long side `(2,)` of the tightest rectangle around an outline [m]."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(outline))
    return np.sort(np.linalg.norm(np.diff(corners[:3], axis=0), axis=1))


def _symmetry(item: SceneItem, seen: SeenObject) -> float:
    """Turn by which headings are alike [rad]; 0 where they cannot be compared."""
    if seen.name == item.name:
        return item.symmetry
    # nobody told which of a seen box's sides is its x axis
    return min(item.symmetry, np.pi / 2) if seen.has_heading else 0.0


def _angles(symmetry: float, estimate: Track, truth: Track) -> Array:
    """Angles `(T,)` between axes, or between headings less a symmetry if these are larger [rad]."""
    z = np.array([0.0, 0.0, 1.0])
    cosines = np.einsum("ij,ij->i", rotate(estimate.q, z), rotate(truth.q, z))
    tilts = np.arccos(np.clip(cosines, -1.0, 1.0))
    if symmetry == 0.0:
        return np.asarray(tilts)
    turns = np.array([yaw_of(a) - yaw_of(b) for a, b in zip(estimate.q, truth.q, strict=True)])
    turns = np.abs((turns + 0.5 * symmetry) % symmetry - 0.5 * symmetry)
    return np.asarray(np.maximum(tilts, turns))
