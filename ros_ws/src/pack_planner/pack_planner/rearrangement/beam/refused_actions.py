"""What the arm refused before, and what an obstacle bars, is impossible to the search."""

from __future__ import annotations

import numpy as np

from pack_core.blocks.planar import QUARTER
from pack_core.blocks.primitive_action import PrimitiveKind
from pack_core.rotations import Array
from pack_planner.rearrangement.collisions import Words, hits
from pack_planner.rearrangement.task import Task

EVERYTHING = np.uint64(2**64 - 1)
"""What is impossible hits all spots, NO_GO among them."""


def bar_grasps(task: Task, kind: PrimitiveKind, poses: Array, words: Words) -> None:
    """Change what grasping or putting down hits at poses `(..., 3)`, words `(..., 2, W)`."""
    turned = np.repeat(poses[..., None, :], 2, axis=-2)
    turned[..., 1, 2] += QUARTER
    _bar(task, kind, turned, words)


def bar_pushes(task: Task, starts: Array, headings: Array, words: Words) -> None:
    """Change what pushes from `(..., 3)` along headings `(...)` hit, words `(..., W)`."""
    _bar(task, PrimitiveKind.PUSH, np.concatenate([starts[..., :2], headings[..., None]], axis=-1), words)


def bar_blocked(task: Task, footprints: Array, *tables: Words) -> None:
    """Change what actions with footprints `(..., rectangles, 6)` hit, tables of words `(..., W)`."""
    is_blocked = hits(footprints, task.obstacles).any(axis=-1)
    for words in tables:
        words[is_blocked] = EVERYTHING


def _bar(task: Task, kind: PrimitiveKind, poses: Array, words: Words) -> None:
    for primitive in task.problem.refused:
        words[primitive.is_like(kind, poses)] = EVERYTHING
