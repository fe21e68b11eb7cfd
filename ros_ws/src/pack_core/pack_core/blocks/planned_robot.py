"""The cell's robot as MoveIt and ros2_control are told of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import describe_robot
from pack_core.robots.moveit import PlannedRobot
from pack_core.robots.ur10e import LIMITS


def planned_robot(_: Mapping[str, Any]) -> PlannedRobot:
    """The robot of the cell, which has no presets, for MoveIt and ros2_control."""
    cell = blocks_cell()
    return PlannedRobot("ur10e", describe_robot(cell), LIMITS, tuple(cell.robot.look))
