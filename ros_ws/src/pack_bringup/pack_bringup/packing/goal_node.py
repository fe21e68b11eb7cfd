"""Sends the packing goal to a running cell: `pack run pack_bringup goal_node`."""

from __future__ import annotations

import sys
from typing import Any

from pack_interfaces.action import PackObject
from pydantic import Field, NonNegativeFloat
from rclpy.executors import ExternalShutdownException

from pack_bringup.graph.graph import load_graph
from pack_bringup.ros.goal_client import GoalClient, follow_goal
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.params import read_parameters


class GoalConfig(Config):
    """The goal."""

    method: str = Field(default="pack_it_in", description="pack_it_in, uninformed_pose or uninformed_physics")
    seed: int = Field(default=0, ge=0, description="of the placement planner's samples")
    timeout: NonNegativeFloat = Field(default=0.0, description="simulated [s]; 0: that of the controller")


class PackGoalNode(GoalClient):
    """Its goal is in its parameters."""

    def __init__(self, **kwargs: Any) -> None:
        names = [node.name for node in load_graph("packing").nodes]
        super().__init__(contracts.PACK_OBJECT, PackObject.Goal(), names, **kwargs)
        self.goal = PackObject.Goal(**read_parameters(self, GoalConfig).model_dump())


def main() -> int:
    """Send one goal to the cell that is running; 0 if the object was packed."""
    try:
        result = follow_goal(PackGoalNode, lambda node: None)
    except PackError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    except (KeyboardInterrupt, ExternalShutdownException):
        return 1
    sys.stdout.write(f"{result.exit_reason}: {result.message}\n")
    return 0 if result.success else 1
