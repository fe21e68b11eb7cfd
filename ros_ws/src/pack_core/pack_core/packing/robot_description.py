"""The packing cell's arm with its pump, as viewers are told of it."""

from __future__ import annotations

import mujoco

from pack_core.packing.cell import PackingCell
from pack_core.robots.described_robot import DescribedRobot
from pack_core.robots.pump import add_pump


def describe_robot(cell: PackingCell) -> DescribedRobot:
    """The arm and the pump; the cup is the link `tool`."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    arm = cell.robot.arm
    add_pump(arm.add_to(spec), cell.pump, arm.flange)
    return DescribedRobot.of(spec, arm.name)
