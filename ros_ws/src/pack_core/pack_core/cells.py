"""The register of cells: which cells there are, and where each package keeps its part of a cell.

A cell is registered once, by its name in `CELLS`. Everything else is found by that name: the modules of
`PARTS`, and the files config/cells/<cell>.yaml, config/graphs/<cell>.yaml and config/nodes/<cell>/. A module
is imported when it is asked for, so that a command loads only what it needs.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from pack_core.errors import ConfigError

CELLS = ("packing", "palletizing", "blocks")
"""Every cell, in the order in which help texts and reports show them."""


@dataclass(frozen=True)
class CellPart:
    """What every cell provides under the same name, or may provide.

    Attributes:
        module: its dotted name, with `{cell}` for the cell's name.
        attribute: the object in that module.
        what: what it is for, for errors and for the guide to a new cell.
        is_optional: whether a cell may do without it.
    """

    module: str
    attribute: str
    what: str
    is_optional: bool = False


PARTS = {
    "contracts": CellPart(
        "pack_core.ros.contracts.{cell}", "CONTRACTS", "the wiring table: topics, services and actions"
    ),
    "robot": CellPart(
        "pack_core.{cell}.planned_robot", "planned_robot", "the robot as MoveIt and ros2_control know it"
    ),
    "evaluator": CellPart(
        "pack_evaluation.{cell}.evaluator", "EVALUATOR", "from one recording to its measures and report"
    ),
    "studies": CellPart(
        "pack_evaluation.{cell}.studies", "STUDIES", "many recordings and benchmarks side by side"
    ),
    "fill_studies": CellPart(
        "pack_evaluation.{cell}.fill.studies", "STUDIES", "benchmarks of filled containers side by side",
        is_optional=True,
    ),
    "shift_studies": CellPart(
        "pack_evaluation.{cell}.shift_studies", "STUDIES", "benchmarks of shifts side by side",
        is_optional=True,
    ),
    "demo": CellPart("pack_bringup.{cell}.commands", "demo", "the command `pack demo CELL`"),
    "goal": CellPart("pack_bringup.{cell}.commands", "goal", "the command `pack goal CELL`"),
    "seeded_goal": CellPart(
        "pack_bringup.{cell}.goals", "seeded_goal", "a goal by a seed, for benchmarks of faults and of hours"
    ),
    "seeded_job": CellPart(
        "pack_bringup.{cell}.goals", "seeded_job", "the same goal with nodes that are started for it"
    ),
    "given_goal": CellPart(
        "pack_bringup.{cell}.goals", "given_goal", "a goal from the text of an order, list or problem"
    ),
    "shift_goal": CellPart(
        "pack_bringup.{cell}.shift_command", "shift_goal", "the goal of a shift", is_optional=True
    ),
    "production": CellPart(
        "pack_bringup.{cell}.production", "PRODUCTION", "what the cell does and has done, for `pack opcua`"
    ),
    "benchmark": CellPart("pack_bringup.{cell}.commands", "benchmark", "the command `pack benchmark CELL`"),
    "replays": CellPart("pack_lockstep.{cell}.replay", "REPLAYS", "the nodes that `pack replay` can replay"),
    "disturbances": CellPart(
        "pack_lockstep.{cell}.disturbances", "DISTURBANCES", "the rows of `pack benchmark hands CELL`",
        is_optional=True,
    ),
    "motion_requests": CellPart(
        "pack_lockstep.{cell}.motion_requests", "record", "what `pack benchmark motion` asks of the arm",
        is_optional=True,
    ),
    "page": CellPart(
        "pack_viewer.{cell}.{cell}_page", "PAGE", "the cell's part of the page in the browser",
        is_optional=True,
    ),
    "run_form": CellPart(
        "pack_viewer.{cell}.ros.{cell}_run_form", "RUN_FORM", "what the page lets one choose for a goal",
        is_optional=True,
    ),
    "commands": CellPart(
        "pack_bringup.{cell}.commands", "APPS", "commands of `pack` that only this cell has", is_optional=True
    ),
    "preset": CellPart(
        "pack_bringup.{cell}.goals", "preset_overrides", "presets for the nodes", is_optional=True
    ),
    "calibration": CellPart(
        "pack_bringup.{cell}.goals", "calibration_overrides", "calibration files for the nodes",
        is_optional=True,
    ),
    "run_files": CellPart(
        "pack_bringup.{cell}.ros.run_files", "RunFiles", "files that the recorder writes beside the bag",
        is_optional=True,
    ),
}  # fmt: skip
"""The parts by name; tests/architecture/test_cells.py asks every cell for all of them."""


def cell_part(cell: str, name: str) -> Any:
    """A cell's part, imported now.

    Args:
        cell: one of `CELLS`.
        name: one of `PARTS`.

    Raises:
        ConfigError: there is no such cell, or the cell lacks the part.
    """
    part = optional_cell_part(cell, name)
    if part is None:
        what, module = PARTS[name].what, PARTS[name].module.format(cell=cell)
        having = ", ".join(cells_with(name)) or "none"
        raise ConfigError(
            f"cell '{cell}' has no {name} ({what}): no {PARTS[name].attribute} in {module}; cells that "
            f"have it: {having}"
        )
    return part


def optional_cell_part(cell: str, name: str) -> Any | None:
    """A cell's part, or None where the cell does without it.

    Raises:
        ConfigError: there is no such cell.
    """
    module = PARTS[name].module.format(cell=check_cell(cell))
    return getattr(import_module(module), PARTS[name].attribute, None) if _exists(module) else None


def cells_with(name: str) -> list[str]:
    """The cells that have a part."""
    return [cell for cell in CELLS if optional_cell_part(cell, name) is not None]


def check_cell(cell: str) -> str:
    """The name of a cell, as given.

    Raises:
        ConfigError: there is no such cell.
    """
    if cell not in CELLS:
        raise ConfigError(f"no cell '{cell}'; allowed: {', '.join(CELLS)} (pack_core/cells.py lists them)")
    return cell


def _exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # the package around it is missing
        return False
