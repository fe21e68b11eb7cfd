"""The blocks cell's arm with its gripper, as viewers are told of it."""

from __future__ import annotations

import mujoco

from pack_core.blocks.cell import BlocksCell
from pack_core.robots.described_robot import DescribedRobot
from pack_core.robots.robotiq_2f85 import add_robotiq_2f85
from pack_core.robots.ur10e import add_ur10e


def describe_robot(cell: BlocksCell) -> DescribedRobot:
    """The arm and the gripper with its fingers; the point between the finger tips is the link `tool`."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    flange = add_ur10e(spec, cell.robot.base.to_pose(), contype=0, conaffinity=0)
    add_robotiq_2f85(flange, spec, pad_friction=1.0, contype=0, conaffinity=0)
    return DescribedRobot.of(spec, "ur10e")
