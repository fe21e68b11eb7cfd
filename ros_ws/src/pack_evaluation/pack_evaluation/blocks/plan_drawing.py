"""Draws a plan step by step, with one small picture for each action."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon

from pack_core.blocks.plan import Action, PickPlace, Plan, Push
from pack_core.blocks.planar import QUARTER, PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.rotations import Array
from pack_evaluation.figures import INK

PAPER, TABLE = "#ffffff", "#f4f1ea"
WAITING, HOME, MOVING = "#c9ced6", "#7fb08a", "#2f6db5"
CARRY, PUSH = "#2f6db5", "#d9722e"
GRIPPER = "#3d434b"
TILE = 1.75
"""Edge length of one small picture [inch]."""


def draw_plan(problem: Problem, plan: Plan, columns: int = 6) -> Figure:
    """Draw the start, then for every action the block before and after it and the fingers that move it.

    Blocks on their goals are green, those that wait grey; goals are outlined. Blue: picked and placed;
    orange: pushed.
    """
    states = list(plan.states(problem.starts))
    columns = max(1, min(columns, len(states)))
    rows = -(-len(states) // columns)
    figure = Figure(
        figsize=(columns * TILE, rows * (TILE + 0.2) + 0.3), facecolor=PAPER, layout="constrained"
    )
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat:
        axes.set_axis_off()
    _draw_state(grid.flat[0], problem, states[0], None)
    grid.flat[0].set_title("start", fontsize=8, color=INK, pad=3)
    for number, (axes, action) in enumerate(zip(list(grid.flat)[1:], plan.actions, strict=False), 1):
        _draw_state(axes, problem, states[number], action)
        axes.set_title(f"{number}  {_words(action)}", fontsize=8, color=INK, pad=3)
    figure.suptitle(_heading(plan), fontsize=10, color=INK, x=0.02, ha="left")
    return figure


def write_plan(problem: Problem, plan: Plan, path: Path, columns: int = 6) -> Path:
    """Save `draw_plan`; the file's ending decides the format."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draw_plan(problem, plan, columns).savefig(path, dpi=150)
    return path


def _heading(plan: Plan) -> str:
    pushes = sum(isinstance(action, Push) for action in plan.actions)
    text = f"{len(plan.actions)} actions, {pushes} of them pushes; lower bound {plan.lower_bound}"
    return text if plan.is_solved else f"{plan.status.name}: {plan.diagnosis.text}"


def _words(action: Action) -> str:
    if isinstance(action, Push):
        return f"push {action.block} {1e3 * action.distance:.0f} mm"
    return f"place {action.block}"


def _draw_state(axes: Axes, problem: Problem, poses: Mapping[str, PlanarPose], action: Action | None) -> None:
    moved = action.block if action is not None else ""
    draw_table(axes, problem, poses, moved, PUSH if isinstance(action, Push) else MOVING)
    if action is not None:
        _draw_action(axes, problem, action)


def draw_table(
    axes: Axes, problem: Problem, poses: Mapping[str, PlanarPose], moved: str, moving: str
) -> None:
    """Draw workspace, goals and blocks; the block `moved` has the colour `moving`."""
    corners = np.array(problem.workspace)
    axes.add_patch(Polygon(corners, facecolor=TABLE, edgecolor="#d9d3c5", lw=0.8))
    for name, goal in problem.goals.items():
        outline = _outline(problem, name, goal)
        axes.add_patch(Polygon(outline, fill=False, edgecolor="#b6ab93", lw=0.6, ls=(0, (3, 2))))
    for name, pose in poses.items():
        is_moved = name == moved
        colour = moving if is_moved else HOME if _is_home(problem, name, pose) else WAITING
        outline = _outline(problem, name, pose)
        axes.add_patch(Polygon(outline, facecolor=colour, edgecolor=PAPER, lw=0.7, zorder=2))
        axes.text(
            pose.x, pose.y, name, ha="center", va="center", fontsize=5.5, zorder=4,
            color=PAPER if is_moved else INK, rotation=_upright(pose.yaw),
        )  # fmt: skip
    (x0, y0), (x1, y1) = corners.min(0), corners.max(0)
    pad = 0.03 * max(x1 - x0, y1 - y0)
    axes.set(xlim=(x0 - pad, x1 + pad), ylim=(y0 - pad, y1 + pad), aspect="equal")


def _draw_action(axes: Axes, problem: Problem, action: Action) -> None:
    """Draw the block before the action, its way, and the fingers."""
    colour = PUSH if isinstance(action, Push) else CARRY
    ghost = _outline(problem, action.block, action.start)
    axes.add_patch(Polygon(ghost, facecolor=colour, alpha=0.14, edgecolor=colour, lw=0.7, zorder=1))
    arrow = FancyArrowPatch(
        (action.start.x, action.start.y), (action.end.x, action.end.y), arrowstyle="-|>", mutation_scale=7,
        color=colour, lw=1.0, alpha=0.85, zorder=3, shrinkA=0, shrinkB=5,
        connectionstyle="arc3,rad=0" if isinstance(action, Push) else "arc3,rad=0.18",
    )  # fmt: skip
    axes.add_patch(arrow)
    for finger in _fingers(problem, action):
        axes.add_patch(Polygon(finger, facecolor=GRIPPER, lw=0, zorder=3))


def _fingers(problem: Problem, action: Action) -> list[Array]:
    """Outlines of both fingers at the end of the action."""
    gripper, size = problem.gripper, problem.sizes[action.block]
    if isinstance(action, PickPlace):
        heading, ahead = action.end.yaw + action.grasp * QUARTER, 0.0
        inner = size[action.grasp] / 2
    else:
        _, along = size.across_and_along(action.start, action.direction)
        heading, ahead = action.direction + QUARTER, -along / 2 - gripper.finger_width / 2
        inner = gripper.push_gap / 2
    centre = action.end.moved(ahead, heading - QUARTER)
    outlines = []
    for sign in (1.0, -1.0):
        middle = centre.moved(sign * (inner + gripper.finger_thickness / 2), heading)
        outlines.append(_rectangle(middle, heading, gripper.finger_thickness, gripper.finger_width))
    return outlines


def _outline(problem: Problem, name: str, pose: PlanarPose) -> Array:
    size = problem.sizes[name]
    return _rectangle(pose, pose.yaw, size.x, size.y)


def _rectangle(centre: PlanarPose, heading: float, length: float, width: float) -> Array:
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [length / 2, width / 2]
    cosine, sine = math.cos(heading), math.sin(heading)
    return np.asarray(centre.p + corners @ np.array([[cosine, sine], [-sine, cosine]]))


def _upright(yaw: float) -> float:
    """Angle [deg] at which a label on a square is parallel to a side and readable."""
    return (math.degrees(yaw) + 45.0) % 90.0 - 45.0


def _is_home(problem: Problem, name: str, pose: PlanarPose) -> bool:
    return problem.goals[name].distance_to(pose) <= problem.tolerance.position
