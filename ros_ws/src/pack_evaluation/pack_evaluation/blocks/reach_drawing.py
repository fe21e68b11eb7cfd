"""Draws where one action can bring a block, as Figs. 2 to 4 of Sotiropoulos and Sandzimier.

The centres that a block can be carried to at one yaw, by one grasp, are the workspace without what the block
and the fingers beside it would hit: the Minkowski sum of every other block with their mirrored footprints.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from shapely.geometry.base import BaseGeometry

from pack_core.blocks.plan import Plan, Push
from pack_core.blocks.planar import QUARTER, PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.no_fit import no_fit_polygon
from pack_evaluation.blocks.plan_drawing import CARRY, PAPER, PUSH, draw_table
from pack_evaluation.figures import INK

Poses = Mapping[str, PlanarPose]
YAWS = 36
"""Of a block that is put down, in half a turn, after which its footprint and the fingers' are the same."""
PUSH_STEP = 0.001
"""Between the lengths of a push that are tried [m]."""
PANEL = 3.4
"""Edge length of one picture [inch]."""


def draw_reach(problem: Problem, plan: Plan) -> Figure:
    """Draw three pictures: the plan's first block carried, and the last one pushed, carried and pushed.

    Blue: where its centre can be put down, at some yaw. Orange: what it covers while it is pushed.
    """
    states = list(plan.states(problem.starts))
    pushes = [number for number, action in enumerate(plan.actions) if isinstance(action, Push)]
    number = pushes[-1] if pushes else len(plan.actions) - 1
    first, last = plan.actions[0].block, plan.actions[number].block
    figure = Figure(figsize=(3 * PANEL, PANEL + 0.3), facecolor=PAPER)
    panels = figure.subplots(1, 3)
    _draw(panels[0], problem, states[0], first, carry_reach(problem, states[0], first), CARRY)
    _draw(panels[1], problem, states[number], last, carry_reach(problem, states[number], last), CARRY)
    _draw(panels[2], problem, states[number], last, push_reach(problem, states[number], last), PUSH)
    titles = (
        f"{first} carried, at the start",
        f"{last} carried, before its push",
        f"{last} pushed, from there",
    )
    for axes, title in zip(panels, titles, strict=True):
        axes.set_title(title, fontsize=9, color=INK, pad=4)
    figure.tight_layout()
    return figure


def write_reach(problem: Problem, plan: Plan, path: Path) -> Path:
    """Save `draw_reach`; the file's ending decides the format."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draw_reach(problem, plan).savefig(path, dpi=110)
    return path


def carry_reach(problem: Problem, poses: Poses, block: str) -> BaseGeometry:
    """Positions [m] at which a block can be put down in one action, at some yaw."""
    blocks = {name: _block(problem, name, pose) for name, pose in poses.items() if name != block}
    regions = [
        _free_centres(problem, block, list(blocks.values()), yaw, grasp)
        for grasp in _grasps(problem, block, poses[block], shapely.union_all(list(blocks.values())))
        # The goal's yaw is among them, the only one at which a dense grid has room.
        for yaw in problem.goals[block].yaw + np.linspace(0.0, np.pi, YAWS, endpoint=False)
    ]
    return shapely.union_all(regions)


def push_reach(problem: Problem, poses: Poses, block: str) -> BaseGeometry:
    """What a block covers in all pushes that are possible from where it stands [m]."""
    start, gripper = poses[block], problem.gripper
    others = shapely.union_all([_block(problem, name, pose) for name, pose in poses.items() if name != block])
    lengths = np.arange(gripper.min_push, gripper.max_push + PUSH_STEP / 2, PUSH_STEP)
    covered = []
    for heading in start.yaw + QUARTER * np.arange(4):
        along = PlanarPose(start.x, start.y, float(heading))
        for length in lengths:
            end = _at(_box(problem, block, 0.0), start.moved(float(length), along.yaw))
            if not shapely.Polygon(problem.workspace).covers(end):
                break
            if _at(_push_box(problem, block, along.yaw - start.yaw, float(length)), along).intersects(others):
                break
            covered.append(end)
    return shapely.union_all(covered)


def _grasps(problem: Problem, block: str, pose: PlanarPose, others: BaseGeometry) -> Iterator[int]:
    """The grasps by which a block can be picked up where it stands."""
    for grasp in (0, 1):
        opening = problem.gripper.grasp_opening(problem.sizes[block][grasp])
        fingers = [_at(finger, pose) for finger in _fingers(problem, block, grasp)]
        if opening <= problem.gripper.max_opening and not any(f.intersects(others) for f in fingers):
            yield grasp


def _free_centres(
    problem: Problem, block: str, blocks: list[shapely.Polygon], yaw: float, grasp: int
) -> BaseGeometry:
    """Positions of a block at a yaw that keep block and fingers clear of the others, in the workspace."""
    turned = PlanarPose(0.0, 0.0, yaw)
    shapes = [_at(_box(problem, block, problem.gripper.block_margin), turned)]
    shapes += [_at(finger, turned) for finger in _fingers(problem, block, grasp)]
    hit = shapely.union_all([
        no_fit_polygon(*map(shapely.get_coordinates, (other, shape))) for other in blocks for shape in shapes
    ])  # fmt: skip
    return _inset(problem, _at(_box(problem, block, 0.0), turned)).difference(hit)


def _inset(problem: Problem, shape: shapely.Polygon) -> BaseGeometry:
    """Where the shape's origin may be, so that the shape stays in the convex workspace."""
    workspace = shapely.Polygon(problem.workspace)
    moved = [shapely.affinity.translate(workspace, -x, -y) for x, y in shape.exterior.coords]
    return shapely.intersection_all(moved)


def _box(problem: Problem, block: str, margin: float) -> shapely.Polygon:
    size = problem.sizes[block]
    x, y = size.x / 2 + margin, size.y / 2 + margin
    return shapely.box(-x, -y, x, y)


def _block(problem: Problem, block: str, pose: PlanarPose) -> shapely.Polygon:
    return _at(_box(problem, block, 0.0), pose)


def _thicker(problem: Problem, block: str) -> float:
    """By how much a finger is thicker at the top of the tallest block than at that of its own [m]."""
    return problem.gripper.finger_taper * (problem.tallest - problem.sizes[block].z)


def _fingers(problem: Problem, block: str, grasp: int) -> list[shapely.Polygon]:
    """What must be free beside a block at the origin, to grasp it there or to let it go."""
    face, gripper = problem.sizes[block][grasp] / 2, problem.gripper
    outer, half = face + gripper.slab_thickness + _thicker(problem, block), gripper.slab_width / 2
    slabs = [shapely.box(face, -half, outer, half), shapely.box(-outer, -half, -face, half)]
    return [shapely.affinity.rotate(slab, 90 * grasp, origin=(0, 0)) for slab in slabs]


def _push_box(problem: Problem, block: str, turn: float, length: float) -> shapely.Polygon:
    """The room of a push along x, from the fingers behind the block to the block where it stops.

    The block is turned by `turn` against the push [rad], by quarters.
    """
    gripper, level = problem.gripper, PlanarPose(0.0, 0.0)
    across, half = (edge / 2 for edge in problem.sizes[block].across_and_along(level, turn))
    behind = gripper.push_width / 2 + _thicker(problem, block) + gripper.safety_margin
    wide = max(across + gripper.block_margin, behind)
    return shapely.box(-half - gripper.push_tail, -wide, length + half + gripper.block_margin, wide)


def _at(shape: shapely.Polygon, pose: PlanarPose) -> shapely.Polygon:
    turned = shapely.affinity.rotate(shape, pose.yaw, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, pose.x, pose.y)


def _draw(axes: Axes, problem: Problem, poses: Poses, block: str, region: BaseGeometry, colour: str) -> None:
    draw_table(axes, problem, poses, block, colour)
    for part in getattr(region, "geoms", [region]):
        if isinstance(part, shapely.Polygon) and not part.is_empty:
            _fill(axes, part, colour)
    axes.set_axis_off()


def _fill(axes: Axes, part: shapely.Polygon, colour: str) -> None:
    rings = [np.array(ring.coords) for ring in (part.exterior, *part.interiors)]
    codes = [code for ring in rings for code in [Outline.MOVETO, *[Outline.LINETO] * (len(ring) - 1)]]
    outline = Outline(np.concatenate(rings), codes)
    axes.add_patch(PathPatch(outline, facecolor=colour, alpha=0.30, edgecolor=colour, lw=0.4, zorder=1.5))
