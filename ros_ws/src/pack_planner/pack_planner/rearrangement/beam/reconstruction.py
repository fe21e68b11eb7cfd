"""From the search's moves between spots to actions with the blocks' own poses."""

from __future__ import annotations

from collections.abc import Iterable

from pack_core.blocks.plan import Action, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.rotations import Array
from pack_planner.rearrangement.beam.history import BlockMove
from pack_planner.rearrangement.beam.spots import GOAL, STRAIGHT
from pack_planner.rearrangement.beam.states import NO_STAGE, PUSHED
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.carrying import carried
from pack_planner.rearrangement.task import Task


def to_actions(task: Task, tables: Tables, moves: Iterable[BlockMove]) -> list[Action]:
    """Actions of a plan; a block that would be put down where it was picked up is left alone."""
    poses = [PlanarPose(*row) for row in task.starts.tolist()]
    spots = [tables.poses[GOAL + i if home else i] for i, home in enumerate(task.is_home)]
    actions: list[Action] = []
    for move in moves:
        for action, spot in _actions_of(task, tables, move, poses[move.block], spots[move.block]):
            poses[move.block], spots[move.block] = action.end, spot
            if action.start.distance_to(action.end) > STRAIGHT:
                actions.append(action)
    return actions


def _actions_of(
    task: Task, tables: Tables, move: BlockMove, pose: PlanarPose, spot: Array
) -> list[tuple[Action, Array]]:
    """One action, or two by way of a staging pose, each with the spot it ends at."""
    name, end = task.ids[move.block], tables.poses[move.spot]
    if move.grasps == PUSHED:
        return [(Push(name, pose, PlanarPose(float(end[0]), float(end[1]), pose.yaw)), end)]
    first = end if move.stage == NO_STAGE else tables.stage[move.block, move.stage]
    axes = divmod(move.grasps, 2)
    placed = carried(task.problem, name, pose, spot, first, axes)
    actions: list[tuple[Action, Array]] = [(placed, first)]
    if move.stage != NO_STAGE:
        actions.append(
            (Push(name, placed.end, PlanarPose(float(end[0]), float(end[1]), placed.end.yaw)), end)
        )
    return actions
