"""Problem files: where blocks stand and where they are to stand, in millimetres and degrees.

See docs/cells/blocks/manual.md and config/scenarios/blocks/example.yaml.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import yaml
from pydantic import Field, model_validator

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import PlacedBlock, Problem
from pack_core.blocks.problem_check import problems_of
from pack_core.config import Config, parse_config
from pack_core.errors import ConfigError
from pack_core.text.limits import MOST_BLOCKS, MOST_CORNERS, AngleDeg, BlockName, Number
from pack_core.text.reader import read_text
from pack_core.text.shown import listed

Millimetres = Annotated[Number, Field(ge=-10_000.0, le=10_000.0)]
Place = tuple[Millimetres, Millimetres, AngleDeg]
"""x [mm], y [mm], yaw [deg]."""
DIGITS = 6


class BlockEntry(Config):
    """One block; its tag's number is its place in the file, from 0 on."""

    id: BlockName
    start: Place
    goal: Place


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
        blocks=tuple(PlacedBlock(block.id, _pose(block.start)) for block in file.blocks),
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
        for block in problem.blocks
    ]
    corners = [_rounded(1000 * np.array(corner)) for corner in problem.workspace]
    data = {"workspace": corners, "symmetry": problem.symmetry, "blocks": blocks}
    return yaml.safe_dump(data, sort_keys=False, default_flow_style=None, width=100)


def _pose(place: Place) -> PlanarPose:
    x, y, yaw_deg = place
    return PlanarPose(x / 1000, y / 1000, float(np.deg2rad(yaw_deg)))


def _place(pose: PlanarPose) -> list[float]:
    return _rounded([1000 * pose.x, 1000 * pose.y, np.rad2deg(pose.yaw)])


def _rounded(values: Sequence[float] | np.ndarray) -> list[float]:
    return [round(float(value), DIGITS) for value in values]
