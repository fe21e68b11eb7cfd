"""The cell's robot as MoveIt and ros2_control are told of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pack_core.packing.cell import packing_cell
from pack_core.packing.model import describe_robot
from pack_core.robots.moveit import PlannedRobot


def planned_robot(changes: Mapping[str, Any]) -> PlannedRobot:
    """The robot of the cell with the parameters of `sim` in a preset, for MoveIt and ros2_control."""
    cell = packing_cell(changes.get("cell", "{}"))
    return PlannedRobot(
        cell.robot.arm.name, describe_robot(cell), cell.robot.arm.limits, tuple(cell.robot.home)
    )
