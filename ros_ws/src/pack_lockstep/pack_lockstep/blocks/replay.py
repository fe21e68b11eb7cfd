"""Replays of the blocks cell: the rearrangement planner and tag perception."""

from __future__ import annotations

from collections.abc import Sequence

from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.plan import Action, PickPlace, Plan
from pack_core.blocks.planar import PlanarPose, wrapped
from pack_core.blocks.problem import CUBE
from pack_core.blocks.topics import BLOCK_POSES, REARRANGEMENT_EVENTS, TAGS
from pack_core.motion.topics import CAMERA_INFO, IMAGE
from pack_core.ros.messages.blocks import from_request, from_response, from_sighting, from_tags
from pack_core.ros.messages.camera import from_camera_info, from_image
from pack_evaluation.bag import Bag, fitting
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.replay import (
    EXACT_MM,
    Call,
    Replay,
    RunConditions,
    answered,
    calls_in,
    exact_row,
    latest,
    pictures_in,
)
from pack_perception.tags.tag_vision import TagVision, TagVisionConfig
from pack_planner.rearrangement.methods import PlanningConfig
from pack_planner.rearrangement.planning import plan

PATIENCE = 10.0
"""Times the budget of a request that a replay may take to come to the recorded plan, on a slower machine or a
busier one."""


def replay_rearrangement(bag: Bag, run: RunConditions) -> Replay:
    """Plan every rearrangement again until the recorded plan is found, and compare.

    Which plan a planner ends with depends on how many it has time for. Their sequence does not, so planning
    ends as soon as it has come to the recorded one.
    """
    config = load_parameters("blocks/rearrangement", PlanningConfig)
    calls = calls_in(bag, REARRANGEMENT_EVENTS)
    with fitting(bag.path):
        rows = tuple(
            exact_row(f"plan {number}", plan_difference_mm(*_plan_again(config, call)))
            for number, call in enumerate(calls, start=1)
        )
    return Replay("rearrangement", {REARRANGEMENT_EVENTS: len(calls)}, rows)


def _plan_again(config: PlanningConfig, call: Call) -> tuple[Plan, Plan]:
    """The plan that is found now, and the recorded one."""
    request, recorded = call.request, from_response(call.answer)
    budget = request.budget or config.budget
    again = plan(
        from_request(request),
        method=request.method or config.method,
        budget_s=PATIENCE * budget if recorded.is_solved else budget,
        seed=request.seed,
        config=config,
        is_enough=lambda found: actions_difference_mm(found, recorded.actions) <= EXACT_MM,
    )
    return again, recorded


def plan_difference_mm(one: Plan, other: Plan) -> float:
    """The farthest that an action begins or ends elsewhere; inf for another status, proof or action."""
    if (one.status, one.diagnosis.blocks) != (other.status, other.diagnosis.blocks):
        return float("inf")
    return actions_difference_mm(one.actions, other.actions)


def actions_difference_mm(some: Sequence[Action], others: Sequence[Action]) -> float:
    """The same of the actions alone."""
    if [_words(action) for action in some] != [_words(action) for action in others]:
        return float("inf")
    pairs = [
        pair
        for one, other in zip(some, others, strict=True)
        for pair in ((one.start, other.start), (one.end, other.end))
    ]
    return max((_apart_mm(*pair) for pair in pairs), default=0.0)


def _words(action: Action) -> tuple[str, int | None]:
    return action.block, action.grasp if isinstance(action, PickPlace) else None


def _apart_mm(one: PlanarPose, other: PlanarPose) -> float:
    """At most so far are the corners of a cube in one pose from those in another."""
    turn = abs(float(wrapped(one.yaw - other.yaw)))
    return 1e3 * (one.distance_to(other) + CUBE.x * turn)


def replay_tags(bag: Bag, run: RunConditions) -> Replay:
    """Look for the blocks in every picture again, and compare with what was seen."""
    pictures, infos, cell = pictures_in(bag), bag.of(CAMERA_INFO), blocks_cell()
    config = load_parameters("blocks/tags", TagVisionConfig)
    rows = []
    with fitting(bag.path):
        vision = TagVision(config, cell.block, *from_tags(bag.of(TAGS)[-1]))
        for time, message, picture in answered(bag, bag.of(BLOCK_POSES), pictures):
            camera = from_camera_info(latest(infos, time), cell.camera.pinhole.X_WC)
            again = vision.find(from_image(picture, camera), camera, time)
            rows.append(exact_row(f"{time:.3f} s", sighting_difference_mm(again, from_sighting(message))))
    return Replay("tags", {IMAGE: len(pictures)}, tuple(rows))


def sighting_difference_mm(one: BlockSighting, other: BlockSighting) -> float:
    """The farthest that a block was seen elsewhere; inf where other blocks were seen."""
    if _seen(one) != _seen(other):
        return float("inf")
    return max((_apart_mm(pose, other.poses[name]) for name, pose in one.poses.items()), default=0.0)


def _seen(sighting: BlockSighting) -> tuple[list[str], ...]:
    lists = (sighting.poses, sighting.missing, sighting.doubled, map(str, sighting.unknown))
    return tuple(sorted(names) for names in lists)


REPLAYS = {"rearrangement": replay_rearrangement, "tags": replay_tags}
"""The nodes that can be replayed, by name."""
