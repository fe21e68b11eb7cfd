"""Replay of the placement planner: each placement of a goal is planned again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.errors import BagError
from pack_core.packing.goals import PackingMethod
from pack_core.packing.scene import Scene
from pack_core.packing.topics import (
    DESCRIPTION,
    FILL_RESULT,
    SCENE,
    SETTLED_SAMPLES,
)
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.scene import from_scene
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_evaluation.bag import Bag
from pack_evaluation.goals import without_earlier_gaps
from pack_evaluation.packing.from_bag import to_run
from pack_evaluation.packing.run import Run
from pack_lockstep.node_parameters import parameters_of
from pack_lockstep.packing.lockstep_config import PackingPreset
from pack_lockstep.packing.recorded_frames import SAME, check_frames
from pack_lockstep.replay import EXACT_MM, ComparisonRow, Replay
from pack_mpc.cost.weights import load_weights
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_mpc.session import SessionConfig
from pack_planner.placement.placement_planner import (
    PlacementPlanner,
    PlacementPlannerConfig,
    PlacementPlanners,
)

LATEST_SCENE = 0.1
"""A goal's first request has a scene that is no older than this where the goal was accepted [s]."""


@dataclass(frozen=True)
class Request:
    """A request for a placement, with the placement that was recorded.

    Attributes:
        planned_for: time of the scene that the placement was planned for [s].
        answers: how often the planner had answered in this goal before.
        tried: positions of the earlier placements `(n, 3)` [m].
        p_WT: recorded position of the placement `(3,)` [m].
        collisions: recorded collision list of the placement.
    """

    planned_for: float
    answers: int
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
    session = given.parameters("mpc", FillSessionConfig)
    times = [from_stamp(message.header.stamp) for message in bag.of(SETTLED_SAMPLES)]
    rows = tuple(
        _compare_placement(planner, session, request, scenes, seed) for request in requests(run, times)
    )
    return Replay("planner", {SCENE: count}, rows)


def requests(run: Run, planned_for: Sequence[float]) -> Iterator[Request]:
    """The requests of a goal that were taken up, in their order.

    A placement that was taken up is the last that was planned before. Iterations before the first answer
    move above the container's middle and have no placement yet.

    Args:
        run: the goal.
        planned_for: times of the scenes that placements were planned for [s], in order.

    Raises:
        BagError: a placement was taken up that was not planned in the recording.
    """
    done, times = run.iterations, np.array(planned_for)
    numbers, starts = np.unique(done.placements, return_index=True)
    firsts = [int(i) for i in starts[numbers > 0]]
    for n, first in enumerate(firsts):
        before = times[times < done.times[first]]
        if not before.size:
            raise BagError(f"the recording has no message of {SETTLED_SAMPLES} before placement {n + 1}")
        # a request whose answer was lost is sent again, for the same scene and with the same seed
        answers = np.unique(before[before > run.start - LATEST_SCENE]).size - 1
        yield Request(
            float(before[-1]), answers, done.p_WT[firsts[:n]], done.p_WT[first], done.collisions[first]
        )


def _compare_placement(
    planner: PlacementPlanner,
    session: SessionConfig,
    request: Request,
    scenes: Sequence[SceneState],
    seed: int,
) -> ComparisonRow:
    """Compare the recorded placement with the one that is planned for the same scene."""
    radius, lean = session.task.avoid_radius, load_weights(session.weights).lean
    scene = next((scene for scene in scenes if abs(scene.time - request.planned_for) < SAME), None)
    error = float("inf")
    if scene is not None:
        placement = planner.plan(
            scene, np.random.default_rng(seed + request.answers), lean=lean,
            avoid=list(request.tried), avoid_radius=radius,
        )  # fmt: skip
        if placement.X_WO is not None and placement.collisions == request.collisions:
            error = 1e3 * float(np.linalg.norm(placement.X_WO.p - request.p_WT))
    name = f"placement {len(request.tried) + 1}"
    return ComparisonRow(name, int(scene is not None), error, error, EXACT_MM)
