"""How right perception by depth images was: what was seen of which object, and how far off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from scipy.optimize import linear_sum_assignment

from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import Array, Pose, rotate, yaw_of
from pack_evaluation.packing.run import Run, SeenObject, SeenScene
from pack_evaluation.track import Track

FOUND = 0.5
"""Overlap of outlines from which something that was seen stands for an object."""


@dataclass(frozen=True)
class PerceptionErrors:
    """Errors of perception by depth images in one run.

    Attributes:
        objects: number of objects in the container.
        seen: number of objects that perception knew of before the goal.
        found: objects of which one of these covers most.
        positions: of all found objects over the whole goal `(n,)` [m].
        angles: of their axes and headings, less symmetries; headings of the same shapes alone `(n,)` [rad].
        sizes: of lengths and heights of what was seen before the goal `(3 found,)` [m].
        held: the same three of the object on the cup.
        after: number of objects that perception knew of after the goal, number of objects of which one of
            these covers most, and errors of lengths and heights `(3 found,)` [m].
    """

    objects: int
    seen: int
    found: int
    positions: Array
    angles: Array
    sizes: Array
    held: tuple[Array, Array, Array]
    after: tuple[int, int, Array]

    @property
    def is_right_number(self) -> bool:
        """Whether perception knew of all objects and of nothing else."""
        return self.objects == self.seen == self.found

    @property
    def is_right_after(self) -> bool:
        """The same at the end of the goal."""
        return self.objects == self.after[0] == self.after[1]


def quantiles(errors: Array) -> dict[str, float | None]:
    """Median, 95th percentile and largest of absolute errors `(n,)`; None without any."""
    names = ("median", "p95", "max")
    values = np.quantile(np.abs(errors), [0.5, 0.95, 1.0]).tolist() if errors.size else [None] * len(names)
    return dict(zip(names, values, strict=True))


def figures(runs: Sequence[PerceptionErrors]) -> dict[str, Any]:
    """Numbers of objects, and quantiles of the errors of all runs together."""
    return {
        **{name: sum(getattr(run, name) for run in runs) for name in ("objects", "seen", "found")},
        "right_number": sum(run.is_right_number for run in runs),
        **_errors([(run.positions, run.angles, run.sizes) for run in runs]),
        "held": _errors([run.held for run in runs]),
        "after": {
            "seen": sum(run.after[0] for run in runs),
            "found": sum(run.after[1] for run in runs),
            "right_number": sum(run.is_right_after for run in runs),
            "size_mm": quantiles(1e3 * np.concatenate([run.after[2] for run in runs])),
        },
    }


def _errors(runs: Sequence[tuple[Array, Array, Array]]) -> dict[str, Any]:
    """Quantiles of errors of position [m], of angle [rad] and of size [m], of all runs together."""
    positions, angles, sizes = (np.concatenate(parts) for parts in zip(*runs, strict=True))
    return {
        "position_mm": quantiles(1e3 * positions),
        "angle_deg": quantiles(np.rad2deg(angles)),
        "size_mm": quantiles(1e3 * sizes),
    }


def seen_objects(
    known: Scene, estimate: Mapping[str, Pose], true: Scene, truth: Mapping[str, Pose],
    deviations: Mapping[str, SeenDeviations],
) -> SeenScene:  # fmt: skip
    """Match what perception knows to the true objects, by their outlines.

    Args:
        known: the scene as perception describes it.
        estimate: estimated X_WO of its objects; those that were not seen are missing.
        true: the true scene.
        truth: true X_WO of its objects at the same time.
        deviations: standard deviations that perception tells of its objects.
    """
    names = [name for name in known.names if name in estimate]
    seen = [footprint(known.model_of(name), estimate[name]) for name in names]
    outlines = [footprint(item, truth[item.name]) for item in true.objects]
    overlaps = np.array([[s.intersection(t).area / s.union(t).area for t in outlines] for s in seen])
    found = {}
    for i, j in zip(*linear_sum_assignment(-overlaps.reshape(len(seen), len(outlines))), strict=True):
        if overlaps[i, j] > FOUND:
            item, model = true.objects[j], known.model_of(names[i])
            found[item.name] = _compared(model, item, seen[i], outlines[j])
    name, held = true.new_object.name, None
    if name == known.new_object.name and name in estimate and name in truth:
        items = known.new_object, true.new_object
        held = _compared(
            *items, *(footprint(item, X[name]) for item, X in zip(items, (estimate, truth), strict=True))
        )
    return SeenScene(known, {name: estimate[name] for name in names}, found, deviations, held)


def _compared(
    model: SceneItem, item: SceneItem, seen: shapely.Polygon, outline: shapely.Polygon
) -> SeenObject:
    """What was seen of an object as `model`, with the outlines of both from above."""
    height = 2.0 * float(model.half_extents[2] - item.half_extents[2])
    sides = _sides(seen) - _sides(outline)
    alike = type(model) is type(item) and not isinstance(model, ConvexMesh)
    overlap = seen.intersection(outline).area / seen.union(outline).area
    return SeenObject(model.name, alike, float(overlap), (*sides.tolist(), height))


def with_true_names(run: Run, seen: SeenScene, true: Scene) -> Run:
    """The run with the true scene and what was seen of it, which has the true objects' names."""
    names = {item.name: true for true, item in seen.objects.items()}
    collisions = tuple(tuple(names.get(name, name) for name in row) for row in run.iterations.collisions)
    return replace(
        run, scene=true.description(), seen=seen, samples=(),
        estimate={names.get(name, name): track for name, track in run.estimate.items()},
        iterations=replace(run.iterations, collisions=collisions),
    )  # fmt: skip


def perception_errors(run: Run) -> PerceptionErrors | None:
    """The errors in a run whose objects have their true names; None with markers."""
    if (seen := run.seen) is None:
        return None
    held = {} if seen.held is None else {run.held: seen.held}
    after = seen if run.seen_after is None else run.seen_after
    return PerceptionErrors(
        len(run.scene.objects), len(seen.poses), len(seen.objects), *_errors_of(run, seen, seen.objects),
        _errors_of(run, seen, held), (len(after.poses), len(after.objects), _sizes_of(after.objects)),
    )  # fmt: skip


def _errors_of(run: Run, seen: SeenScene, objects: Mapping[str, SeenObject]) -> tuple[Array, Array, Array]:
    """Errors of position [m] and angle [rad] of some objects over the goal, and of size before it [m]."""
    positions, angles = [np.empty(0)], [np.empty(0)]
    for name, item in objects.items():
        estimate = run.estimate[name].between(run.start, run.end)
        truth = run.truth[name].at(estimate.times)
        model, true = seen.scene.model_of(item.name), run.scene.model_of(name)
        positions.append(estimate.distance_to(truth.p))
        angles.append(_angles(_symmetry(true, item), _standing(model, estimate), _standing(true, truth)))
    return np.concatenate(positions), np.concatenate(angles), _sizes_of(objects)


def _sizes_of(objects: Mapping[str, SeenObject]) -> Array:
    """Errors of lengths and heights `(3 n,)` [m]."""
    return np.array([item.sizes for item in objects.values()]).ravel()


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


def _standing(item: SceneItem, track: Track) -> Array:
    """Quaternions `(T, 4)` of an object, as if what has rolled about its own axis had not."""
    return np.array([item.standing(Pose(p, q)).q for p, q in zip(track.p, track.q, strict=True)])


def _angles(symmetry: float, estimate: Array, truth: Array) -> Array:
    """Angles `(T,)` between axes, or between headings less a symmetry if these are larger [rad].

    Args:
        symmetry: turn by which headings are alike [rad]; 0: they are not compared.
        estimate: quaternions `(T, 4)`.
        truth: likewise.
    """
    z = np.array([0.0, 0.0, 1.0])
    cosines = np.einsum("ij,ij->i", rotate(estimate, z), rotate(truth, z))
    tilts = np.arccos(np.clip(cosines, -1.0, 1.0))
    if symmetry == 0.0:
        return np.asarray(tilts)
    turns = np.array([yaw_of(a) - yaw_of(b) for a, b in zip(estimate, truth, strict=True)])
    turns = np.abs((turns + 0.5 * symmetry) % symmetry - 0.5 * symmetry)
    return np.asarray(np.maximum(tilts, turns))
