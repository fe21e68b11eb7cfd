"""Problem files: where blocks stand and where they are to stand, in millimetres and degrees.

See docs/cells/blocks/manual.md and config/scenarios/blocks/example.yaml.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Annotated

import numpy as np
import shapely
import yaml
from pydantic import Field, model_validator
from shapely import affinity

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBE, BlockSize, PlacedBlock, Problem
from pack_core.config import Config, parse_config
from pack_core.errors import ConfigError
from pack_core.text.limits import MOST_BLOCKS, MOST_CORNERS, AngleDeg, BlockName, Number
from pack_core.text.reader import read_text
from pack_core.text.shown import listed

Millimetres = Annotated[Number, Field(ge=-10_000.0, le=10_000.0)]
Place = tuple[Millimetres, Millimetres, AngleDeg]
"""x [mm], y [mm], yaw [deg]."""
TopEdge = Annotated[Number, Field(ge=38.0, le=120.0)]
"""Of a block's top [mm]: a tag on a smaller one has too few pixels to be read."""
HeightMm = Annotated[Number, Field(ge=40.0, le=70.0)]
"""Of a block [mm]: the fingers reach 20 mm below its top, and past the top of the tallest one."""
DIGITS = 6
"""Behind the point, of places in a file that is written [mm, deg]."""
ROUNDING = 1e-6
"""By which a goal may stand over the workspace's edge, as files are written [m]."""
REACH = 1.3
"""Of a UR10e, from its base to its wrist (data sheet) [m]."""
BASE_RADIUS = 0.095
"""Of a UR10e's foot (data sheet) [m]."""


class BlockEntry(Config):
    """One block; its tag's number is its place in the file, from 0 on."""

    id: BlockName
    start: Place
    goal: Place
    size: tuple[TopEdge, TopEdge, HeightMm] | None = None
    """Edges along the block's own x, y and z [mm]; left out: a 2-inch cube."""


class ProblemFile(Config):
    """A problem file as written: lengths in mm, angles in degrees."""

    workspace: Annotated[list[tuple[Millimetres, Millimetres]], Field(min_length=3, max_length=MOST_CORNERS)]
    """Corners [mm] of the convex polygon in which blocks may be put down."""
    symmetry: Annotated[int, Field(ge=1, le=4)] = 1
    blocks: Annotated[list[BlockEntry], Field(min_length=1, max_length=MOST_BLOCKS)]

    @model_validator(mode="after")
    def _ids_differ(self) -> ProblemFile:
        ids = [block.id for block in self.blocks]
        if doubled := sorted({name for name in ids if ids.count(name) > 1}):
            raise ValueError(f"blocks share an id: {', '.join(doubled)}; allowed: every block its own")
        return self


def load_problem(path: Path, cell: BlocksCell | None = None) -> Problem:
    """Read a problem file.

    Args:
        path: the file.
        cell: the cell that shall solve it; None: any.

    Raises:
        ConfigError: there is none, a key or value is not allowed, or the problem contradicts itself.
    """
    return parse_problem(read_text(path), str(path), cell)


def parse_problem(
    text: str, source: str, cell: BlocksCell | None = None, *, goals_only: bool = False
) -> Problem:
    """Read a problem file's text, as `load_problem` does.

    Args:
        text: the text.
        source: names it in errors.
        cell: the cell that shall solve it; None: any.
        goals_only: do not ask whether the blocks can stand where they start: a camera measures that.
    """
    file = parse_config(ProblemFile, text, source)
    problem = Problem(
        blocks=tuple(PlacedBlock(block.id, _pose(block.start), _size(block)) for block in file.blocks),
        goals={block.id: _pose(block.goal) for block in file.blocks},
        workspace=tuple((x / 1000, y / 1000) for x, y in file.workspace),
        symmetry=file.symmetry, starts_may_be_outside=True,
    )  # fmt: skip
    if found := problems_of(problem, cell, goals_only=goals_only):
        raise ConfigError(listed([f"{source}: {one}" for one in found]))
    return problem


def problem_text(problem: Problem) -> str:
    """The file's text of a problem."""
    blocks = [
        {"id": block.id, "start": _place(block.pose), "goal": _place(problem.goals[block.id])}
        | ({} if block.size == CUBE else {"size": _rounded([1000 * edge for edge in block.size])})
        for block in problem.blocks
    ]
    corners = [_rounded(1000 * np.array(corner)) for corner in problem.workspace]
    data = {"workspace": corners, "symmetry": problem.symmetry, "blocks": blocks}
    return yaml.safe_dump(data, sort_keys=False, default_flow_style=None, width=100)


def _pose(place: Place) -> PlanarPose:
    x, y, yaw_deg = place
    return PlanarPose(x / 1000, y / 1000, float(np.deg2rad(yaw_deg)))


def _size(block: BlockEntry) -> BlockSize:
    return CUBE if block.size is None else BlockSize(*(edge / 1000 for edge in block.size))


def _place(pose: PlanarPose) -> list[float]:
    return _rounded([1000 * pose.x, 1000 * pose.y, np.rad2deg(pose.yaw)])


def _rounded(values: Sequence[float] | np.ndarray) -> list[float]:
    return [round(float(value), DIGITS) for value in values]


def problems_of(problem: Problem, cell: BlocksCell | None = None, *, goals_only: bool = False) -> list[str]:
    """Every reason why a problem cannot be solved whatever the plan; empty where none is found.

    Args:
        problem: the problem as read.
        cell: the cell whose table the blocks stand on; None: any.
        goals_only: leave the starts out, where a camera measures them.
    """
    workspace = shapely.Polygon(problem.workspace)
    if wrong := _wrong_workspace(workspace, problem):
        return [f"key 'workspace' {wrong}; allowed: the corners of a convex polygon, in order"]
    goals = dict(problem.goals)
    poses = {"goal": goals} if goals_only else {"start": problem.starts, "goal": goals}
    found = [*_unlike_themselves(problem), *_too_wide(problem)]
    found += [text for what in poses for text in _overlaps(what, poses[what], problem)]
    grown = workspace.buffer(ROUNDING)
    for name, pose in goals.items():
        if not grown.covers(_outline(pose, problem.sizes[name])):
            found.append(
                f"the goal of {name} {_shown(pose)} is outside the workspace; allowed: inside, whole"
            )
    return found if cell is None else [*found, *_out_of_reach(poses, problem, cell)]


def _wrong_workspace(workspace: shapely.Polygon, problem: Problem) -> str:
    if not workspace.is_valid:
        return f"is no simple polygon: {shapely.is_valid_reason(workspace)}"
    if workspace.area < max(size.x * size.y for size in problem.sizes.values()):
        return f"has an area of {1e6 * workspace.area:.0f} mm^2, less than a block"
    if workspace.convex_hull.area - workspace.area > ROUNDING:
        return "is not convex"
    return ""


def _unlike_themselves(problem: Problem) -> Iterator[str]:
    oblong = [name for name, size in problem.sizes.items() if not size.is_square]
    if problem.symmetry == 4 and oblong:
        yield (
            f"key 'symmetry' is 4, and {', '.join(oblong)} is longer than wide; allowed: 1 or 2, as it looks "
            "another after a quarter turn"
        )


def _too_wide(problem: Problem) -> Iterator[str]:
    widest = problem.gripper.max_opening - 2 * problem.gripper.opening_clearance
    for name, size in problem.sizes.items():
        if min(size.x, size.y) > widest:
            yield (
                f"{name} is {1e3 * size.x:.1f} mm by {1e3 * size.y:.1f} mm; allowed: one of both up to "
                f"{1e3 * widest:.1f} mm, that the gripper opens around it"
            )


def _overlaps(what: str, poses: Mapping[str, PlanarPose], problem: Problem) -> Iterator[str]:
    allowed = problem.tolerance.overlap
    outlines = {name: _outline(pose, problem.sizes[name], allowed) for name, pose in poses.items()}
    for first, second in combinations(outlines, 2):
        if outlines[first].intersects(outlines[second]):
            yield f"the {what}s of {first} and {second} overlap; allowed: up to {1e3 * allowed:g} mm"


def _out_of_reach(
    poses_by_kind: Mapping[str, Mapping[str, PlanarPose]], problem: Problem, cell: BlocksCell
) -> Iterator[str]:
    (x, y), (length, width) = cell.table.centre, cell.table.size
    table = shapely.box(x - length / 2, y - width / 2, x + length / 2, y + width / 2)
    base = PlanarPose(*cell.robot.base.position[:2])
    for what, poses in poses_by_kind.items():
        for name, pose in poses.items():
            nearest = BASE_RADIUS + max(problem.sizes[name][:2]) / 2
            place = f"the {what} of {name} {_shown(pose)}"
            if not table.covers(shapely.Point(pose.x, pose.y)):
                yield f"{place} is off the table; allowed: {_extent(table)} (config/cells/blocks.yaml: table)"
            elif not nearest <= (distance := pose.distance_to(base)) <= REACH:
                yield (
                    f"{place} is {1e3 * distance:.0f} mm from the robot's base; allowed: "
                    f"{1e3 * nearest:.0f} to {1e3 * REACH:.0f} mm"
                )


def _outline(pose: PlanarPose, size: BlockSize, less: float = 0.0) -> shapely.Polygon:
    """What a block covers, its edges `less` shorter [m]."""
    x, y = (size.x - less) / 2, (size.y - less) / 2
    centred = shapely.box(-x, -y, x, y)
    turned = affinity.rotate(centred, pose.yaw, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, pose.x, pose.y)


def _shown(pose: PlanarPose) -> str:
    return f"({1e3 * pose.x:.1f}, {1e3 * pose.y:.1f}) mm"


def _extent(table: shapely.Polygon) -> str:
    x0, y0, x1, y1 = (1e3 * value for value in table.bounds)
    return f"x {x0:.0f} to {x1:.0f} mm, y {y0:.0f} to {y1:.0f} mm"
