"""Refuses problems that contradict themselves, or that a cell's arm cannot reach."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

import shapely
from shapely import affinity

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem

ROUNDING = 1e-6
"""By which a goal may stand over the workspace's edge, as files are written [m]."""
REACH = 1.3
"""Of a UR10e, from its base to its wrist (data sheet) [m]."""
BASE_RADIUS = 0.095
"""Of a UR10e's foot (data sheet) [m]."""


def problems_of(problem: Problem, cell: BlocksCell | None = None, *, goals_only: bool = False) -> list[str]:
    """Every reason why a problem cannot be solved whatever the plan; empty where none is found.

    Args:
        problem: the problem as read.
        cell: the cell whose table the blocks stand on; None: any.
        goals_only: leave the starts out, where a camera measures them.
    """
    workspace = shapely.Polygon(problem.workspace)
    if wrong := _wrong_workspace(workspace, problem.side):
        return [f"key 'workspace' {wrong}; allowed: the corners of a convex polygon, in order"]
    goals = dict(problem.goals)
    poses = {"goal": goals} if goals_only else {"start": problem.starts, "goal": goals}
    found = [text for what in poses for text in _overlaps(what, poses[what], problem)]
    grown = workspace.buffer(ROUNDING)
    for name, pose in goals.items():
        if not grown.covers(_square(pose, problem.side)):
            found.append(
                f"the goal of {name} {_shown(pose)} is outside the workspace; allowed: inside, whole"
            )
    return found if cell is None else [*found, *_out_of_reach(poses, problem.side, cell)]


def _wrong_workspace(workspace: shapely.Polygon, side: float) -> str:
    if not workspace.is_valid:
        return f"is no simple polygon: {shapely.is_valid_reason(workspace)}"
    if workspace.area < side**2:
        return f"has an area of {1e6 * workspace.area:.0f} mm^2, less than a block"
    if workspace.convex_hull.area - workspace.area > ROUNDING:
        return "is not convex"
    return ""


def _overlaps(what: str, poses: Mapping[str, PlanarPose], problem: Problem) -> Iterator[str]:
    allowed = problem.tolerance.overlap
    squares = {name: _square(pose, problem.side - allowed) for name, pose in poses.items()}
    for first, second in combinations(squares, 2):
        if squares[first].intersects(squares[second]):
            yield f"the {what}s of {first} and {second} overlap; allowed: up to {1e3 * allowed:g} mm"


def _out_of_reach(
    poses_by_kind: Mapping[str, Mapping[str, PlanarPose]], side: float, cell: BlocksCell
) -> Iterator[str]:
    (x, y), (length, width) = cell.table.centre, cell.table.size
    table = shapely.box(x - length / 2, y - width / 2, x + length / 2, y + width / 2)
    base = PlanarPose(*cell.robot.base.position[:2])
    nearest = BASE_RADIUS + side / 2
    for what, poses in poses_by_kind.items():
        for name, pose in poses.items():
            place = f"the {what} of {name} {_shown(pose)}"
            if not table.covers(shapely.Point(pose.x, pose.y)):
                yield f"{place} is off the table; allowed: {_extent(table)} (config/cells/blocks.yaml: table)"
            elif not nearest <= (distance := pose.distance_to(base)) <= REACH:
                yield (
                    f"{place} is {1e3 * distance:.0f} mm from the robot's base; allowed: "
                    f"{1e3 * nearest:.0f} to {1e3 * REACH:.0f} mm"
                )


def _square(pose: PlanarPose, side: float) -> shapely.Polygon:
    centred = shapely.box(-side / 2, -side / 2, side / 2, side / 2)
    turned = affinity.rotate(centred, pose.yaw, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, pose.x, pose.y)


def _shown(pose: PlanarPose) -> str:
    return f"({1e3 * pose.x:.1f}, {1e3 * pose.y:.1f}) mm"


def _extent(table: shapely.Polygon) -> str:
    x0, y0, x1, y1 = (1e3 * value for value in table.bounds)
    return f"x {x0:.0f} to {x1:.0f} mm, y {y0:.0f} to {y1:.0f} mm"
