"""Replays recorded scenes through the placement planner and compares the goal's placements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pack_core.errors import BagError
from pack_core.packing.method import PackingMethod
from pack_core.packing.scene import Scene
from pack_core.packing.topics import DESCRIPTION, FILL_RESULT, SCENE
from pack_core.ros.scene_messages import from_scene
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_evaluation.bag import Bag
from pack_evaluation.goals import without_earlier_gaps
from pack_evaluation.packing.from_bag import to_run
from pack_evaluation.packing.run import Run
from pack_lockstep.node_parameters import parameters_of
from pack_lockstep.packing.presets import PackingPreset
from pack_lockstep.packing.replay.comparison import ComparisonRow, Replay, check_frames
from pack_mpc.session import SessionConfig
from pack_mpc.weights import load_weights
from pack_planner.placement.placement_planner import (
    PlacementPlanner,
    PlacementPlannerConfig,
    PlacementPlanners,
)

WINDOW = 0.05
"""Requests are not recorded; a request's scene is one of those this close to the time it was sent [s]."""
LIMIT_MM = 1e-6
"""The same scene gives the same placement, so only rounding is allowed."""


@dataclass(frozen=True)
class Request:
    """A request for a placement, with the placement that was recorded.

    Attributes:
        sent: approximate time of the request [s].
        tried: positions of the earlier placements `(n, 3)` [m].
        p_WT: recorded position of the placement `(3,)` [m].
        collisions: recorded collision list of the placement.
    """

    sent: float
    tried: Array
    p_WT: Array
    collisions: tuple[str, ...]


def replay_planner(
    bag: Bag,
    *,
    seed: int,
    method: PackingMethod = PackingMethod.PACK_IT_IN,
    preset: PackingPreset | None = None,
) -> Replay:
    """Plan each placement of the goal again and compare it with the recorded one.

    Args:
        bag: the recording.
        seed: seed of the goal.
        method: method of the goal.
        preset: preset of the run; None: config/nodes without changes.

    Raises:
        BagError: the recording lacks a topic or too many of its messages, or is that of a fill job.
    """
    if bag.of(FILL_RESULT):
        raise BagError(
            f"{bag.path} is of a fill job; what such a job asks of the planner is not recorded; "
            "--node perception can be replayed"
        )
    run = to_run(bag)
    bag = without_earlier_gaps(bag, run.start, latched=(DESCRIPTION,))
    scenes = [from_scene(message) for message in bag.of(SCENE)]
    min_rate = float(parameters_of("packing/perception")[0]["min_rate"])
    count = check_frames(bag, SCENE, [scene.time for scene in scenes], min_rate)
    scene = Scene.from_yaml(bag.of(DESCRIPTION)[-1].data, DESCRIPTION)
    given = preset or PackingPreset()
    config = given.parameters("planner", PlacementPlannerConfig)
    planner = PlacementPlanners(scene, given.packing_cell(), config).of(method.placement_variant)
    session = given.parameters("mpc", SessionConfig)
    rows = tuple(
        _compare(planner, session, request, _near(scenes, request.sent), seed) for request in requests(run)
    )
    return Replay("planner", {SCENE: count}, rows)


def requests(run: Run) -> Iterator[Request]:
    """The requests of a goal in their order.

    The first is sent at the goal's start, each later one once the object is out of the container again.
    Iterations before the first answer move above the container's middle and have no placement yet.
    """
    done = run.iterations
    numbers, starts = np.unique(done.placements, return_index=True)
    firsts = [int(i) for i in starts[numbers > 0]]
    for n, first in enumerate(firsts):
        sent = run.start if n == 0 else _out(run, firsts[n - 1], first)
        yield Request(sent, done.p_WT[firsts[:n]], done.p_WT[first], done.collisions[first])


def _out(run: Run, start: int, end: int) -> float:
    """When, in iterations `start` to `end`, the placement was given up and the object was out [s]."""
    done, scene = run.iterations, run.scene
    above = [stage == "PRE_PACK" for stage in done.stages]
    back = [i for i in range(start + 1, end) if above[i] and not above[i - 1]]
    bottoms = run.estimate[run.held].at(done.times).p[:, 2] - scene.new_object.half_extents[2]
    out = [i for i in range(back[-1] if back else end, end) if bottoms[i] >= scene.rim]
    return float(done.times[min(out[0] + 1, end) if out else end - 1])


def _near(scenes: list[SceneState], time: float) -> list[SceneState]:
    return [scene for scene in scenes if abs(scene.time - time) <= WINDOW]


def _compare(
    planner: PlacementPlanner, session: SessionConfig, request: Request, scenes: list[SceneState],
    seed: int,
) -> ComparisonRow:  # fmt: skip
    """Compare the recorded placement with the nearest of those that are planned for the scenes."""
    radius, lean = session.task.avoid_radius, load_weights(session.weights).lean
    best, planned = float("inf"), 0
    for scene in scenes:
        placement = planner.plan(
            scene, np.random.default_rng(seed + len(request.tried)), lean=lean,
            avoid=list(request.tried), avoid_radius=radius,
        )  # fmt: skip
        planned += 1
        if placement.X_WO is not None and placement.collisions == request.collisions:
            best = min(best, 1e3 * float(np.linalg.norm(placement.X_WO.p - request.p_WT)))
        if best <= LIMIT_MM:
            break
    return ComparisonRow(f"placement {len(request.tried) + 1}", planned, best, best, LIMIT_MM)
