"""Problems that contradict themselves, and where."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import combinations

import numpy as np

from pack_core.blocks.plan import Diagnosis
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import PlacedBlock, Problem
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import (
    are_inside,
    corners_of,
    edges,
    hits,
    is_convex,
    outlines,
    rows_of,
    shapes_of,
    too_wide,
)

SYMMETRIES = (1, 2, 4)
"""Headings at which a block looks the same: none but one, half turns, quarter turns."""


def find_fault(problem: Problem) -> Diagnosis | None:
    """The first contradiction of a problem; None for a sound one."""
    for check in CHECKS:
        for fault in check(problem):
            return fault
    return None


def _check_ids(problem: Problem) -> Iterator[Diagnosis]:
    ids = [block.id for block in problem.blocks]
    if twice := tuple(sorted({name for name in ids if ids.count(name) > 1})):
        yield Diagnosis(f"block ids occur more than once: {_list(twice)}", twice)
    if unknown := tuple(name for name in problem.goals if name not in ids):
        yield Diagnosis(f"goals of blocks that are not there: {_list(unknown)}", unknown)


def _check_numbers(problem: Problem) -> Iterator[Diagnosis]:
    for what, poses in _poses(problem):
        if broken := tuple(name for name, pose in poses.items() if not pose.is_finite):
            yield Diagnosis(f"the {what} of {_list(broken)} is not finite", broken)
    if problem.symmetry not in SYMMETRIES:
        yield Diagnosis(f"symmetry is {problem.symmetry}; allowed: {_list(map(str, SYMMETRIES))}")
    for block in problem.blocks:
        yield from _check_size(problem, block)


def _check_size(problem: Problem, block: PlacedBlock) -> Iterator[Diagnosis]:
    size, gripper = block.size, problem.gripper
    if not np.isfinite(size).all() or min(size) <= 0:
        yield Diagnosis(
            f"the edges of {block.id} are {_list(map(str, size))} m; allowed: above 0", (block.id,)
        )
    elif size.z <= gripper.insertion:
        yield Diagnosis(
            f"{block.id} is {1e3 * size.z:.1f} mm high; allowed: above {1e3 * gripper.insertion:.1f} mm, by "
            "which the fingers reach below its top",
            (block.id,),
        )
    elif problem.symmetry == 4 and not size.is_square:
        yield Diagnosis(f"symmetry is 4; allowed: 1 or 2, as {block.id} is longer than wide", (block.id,))
    elif too_wide(size, gripper).all():
        width = min(size.x, size.y)
        opening = gripper.grasp_opening(width)
        yield Diagnosis(
            f"blocks {1e3 * width:.1f} mm wide need an opening of {1e3 * opening:.1f} mm; "
            f"the gripper opens {1e3 * gripper.max_opening:.1f} mm",
            tuple(other.id for other in problem.blocks if other.size == size),
        )


def _check_workspace(problem: Problem) -> Iterator[Diagnosis]:
    corners = np.array(problem.workspace, dtype=float).reshape(-1, 2)
    if not np.isfinite(corners).all() or not is_convex(problem.workspace):
        yield Diagnosis(f"the workspace is no convex polygon of 3 corners or more: {corners.tolist()}")


def _check_inside(problem: Problem) -> Iterator[Diagnosis]:
    half_planes = edges(problem.workspace)
    slack = np.array([0.0, 0.0, problem.tolerance.position])
    for what, poses in _poses(problem):
        if what == "start" and problem.starts_may_be_outside:
            continue
        grown = half_planes + slack if what == "start" else half_planes
        rows, shapes = rows_of(poses.values()), _shapes(problem, poses)
        for i in np.flatnonzero(~are_inside(rows, shapes, grown)):
            corners, name = corners_of(rows[i], shapes[i]), list(poses)[i]
            heights = (corners @ grown[:, :2].T - grown[:, 2]).max(axis=1)
            x, y = corners[int(np.argmax(heights))]
            yield Diagnosis(
                f"the {what} of {name} is outside the workspace: its corner ({x:.4f}, {y:.4f}) m "
                f"by {1e3 * heights.max():.1f} mm",
                (name,),
            )


def _check_overlaps(problem: Problem) -> Iterator[Diagnosis]:
    margins = {"start": -problem.tolerance.overlap / 2, "goal": problem.gripper.block_margin}
    rules = {
        "start": f"overlap by more than {1e3 * problem.tolerance.overlap:.1f} mm: measure them again",
        "goal": f"are less than {2e3 * problem.gripper.block_margin:.1f} mm apart",
    }
    for what, poses in _poses(problem):
        grown = outlines(rows_of(poses.values()), _shapes(problem, poses), margins[what])
        words, names = hits(grown[:, None], grown), list(poses)
        for i, j in combinations(range(len(names)), 2):
            if int(words[i, j // 64]) >> (j % 64) & 1:
                yield Diagnosis(
                    f"the {what}s of {names[i]} and {names[j]} {rules[what]}", (names[i], names[j])
                )


def _check_obstacles(problem: Problem) -> Iterator[Diagnosis]:
    obstacles, goals = problem.obstacles, dict(problem.goals)
    shapes = _shapes(problem, obstacles)
    standing = outlines(rows_of(obstacles.values()), shapes, problem.gripper.block_margin)
    for goal, pose in goals.items():
        there = outlines(rows_of([pose]), _shapes(problem, [goal]))
        is_hit = np.any(hits(standing[:, None], there), axis=-1).tolist()
        if in_way := tuple(name for name, hit in zip(obstacles, is_hit, strict=True) if hit):
            yield Diagnosis(f"{_list(in_way)} stands on the goal of {goal}: take it away", (goal, *in_way))


CHECKS: Sequence[Callable[[Problem], Iterator[Diagnosis]]] = (
    _check_ids, _check_numbers, _check_workspace, _check_inside, _check_overlaps,
    _check_obstacles,
)  # fmt: skip


def _poses(problem: Problem) -> Iterable[tuple[str, dict[str, PlanarPose]]]:
    return ("start", problem.starts), ("goal", dict(problem.goals))


def _shapes(problem: Problem, ids: Iterable[str]) -> Array:
    sizes = problem.sizes
    return shapes_of([sizes[name] for name in ids], problem.tallest)


def _list(names: Iterable[str]) -> str:
    return ", ".join(names)
