"""A run as arrays, ready to be measured and drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.packing.settled_sample import SettledSample
from pack_core.rotations import Array, Pose
from pack_evaluation.goals import RecordedRun
from pack_evaluation.track import Track


def no_rows() -> Array:
    """An empty array `(0,)`."""
    return np.empty(0)


@dataclass(frozen=True)
class Iterations:
    """The controller's N iterations for one goal; by default none, as where no placement was found.

    Attributes:
        times: time of the state that was planned from `(N,)` [s].
        elapsed: time since the goal was accepted `(N,)` [s].
        stages: names of the stages, N of them.
        distance: estimated distance of the held object from its packing pose `(N,)` [m].
        cost: cost of the planned trajectory `(N,)`.
        ms: wall clock time of each iteration `(N,)` [ms].
        placements: number of placements tried so far `(N,)`.
        p_WT: packing position `(N, 3)` [m].
        q_WT: packing orientation `(N, 4)`, wxyz.
        collisions: collision list G of the placement, N of them.
    """

    times: Array = field(default_factory=no_rows)
    elapsed: Array = field(default_factory=no_rows)
    stages: tuple[str, ...] = ()
    distance: Array = field(default_factory=no_rows)
    cost: Array = field(default_factory=no_rows)
    ms: Array = field(default_factory=no_rows)
    placements: Array = field(default_factory=no_rows)
    p_WT: Array = field(default_factory=lambda: np.empty((0, 3)))
    q_WT: Array = field(default_factory=lambda: np.empty((0, 4)))
    collisions: tuple[tuple[str, ...], ...] = ()


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
        scene: the scene as perception described it.
        poses: X_WO of what it knew of, by its own names.
        objects: what was found, by the true object's name.
        deviations: standard deviations that perception told of what it knew, by its own names.
        held: what was seen of the object on the cup; None in files from before it was looked at.
    """

    scene: Scene
    poses: Mapping[str, Pose]
    objects: Mapping[str, SeenObject]
    deviations: Mapping[str, SeenDeviations] = field(default_factory=dict)
    held: SeenObject | None = None


@dataclass(frozen=True)
class Run(RecordedRun):
    """One goal of a run.

    Attributes:
        scene: shapes, sizes and masses; no poses.
        start: when the goal was accepted [s].
        end: when it ended [s]; of a cut recording, the last iteration.
        iterations: the controller's iterations.
        truth: true poses by object, the held one included.
        estimate: poses that perception estimated, by object.
        joint_times: times of the joint positions `(J,)` [s].
        joints: measured joint positions `(J, 7)` [rad].
        force_times: times of the forces `(F,)` [s].
        force: load on the cup less the held object's weight, magnitude `(F,)` [N].
        release_reason: why the pump let go; empty if it did not.
        real_time_factors: achieved real-time factors, one for each second of wall clock time.
        outcome: fields of the action's result; empty when none was recorded.
        arm: name of the arm, one of `pack_core.robots.packing_arms`.
        samples: some settled samples of the first placement, the cheapest first; empty if none were recorded.
        seen: what depth cameras saw before the goal; None with markers.
        seen_after: what perception knew at its end; None with markers, and in older files.
    """

    scene: Scene
    start: float
    end: float
    iterations: Iterations
    truth: dict[str, Track]
    estimate: dict[str, Track]
    joint_times: Array
    joints: Array
    force_times: Array
    force: Array
    release_reason: str = ""
    real_time_factors: Array = field(default_factory=no_rows)
    outcome: dict[str, Any] = field(default_factory=dict)
    arm: str = "panda"
    samples: tuple[SettledSample, ...] = ()
    seen: SeenScene | None = None
    seen_after: SeenScene | None = None

    @property
    def held(self) -> str:
        """Name of the object that is packed."""
        return self.scene.new_object.name
