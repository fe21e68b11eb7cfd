"""The palletizing cell's arm with its gripper, as viewers are told of it."""

from __future__ import annotations

import mujoco

from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.described_robot import DescribedRobot
from pack_core.robots.kr210 import add_kr210


def describe_robot(cell: PalletizingCell) -> DescribedRobot:
    """The arm on its nominal base, with rigid gears, and the gripper; its face is the link `tool`."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    cell.tool.add_to(add_kr210(spec, cell.arm.X_WB, look=True), look=True)
    return DescribedRobot.of(spec, "kr210")
