"""The cell's robot as MoveIt and ros2_control are told of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import describe_robot
from pack_core.robots.kr210 import LIMITS
from pack_core.robots.moveit import PlannedRobot


def planned_robot(_: Mapping[str, Any]) -> PlannedRobot:
    """The robot of the cell, which is the same in all presets, for MoveIt and ros2_control."""
    cell = palletizing_cell()
    return PlannedRobot("kr210", describe_robot(cell), LIMITS, tuple(cell.arm.home))
