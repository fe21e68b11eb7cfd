"""Sends an order to a running cell: `pack run pack_bringup order_node --ros-args -p file:=order.json`."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

from pack_interfaces.action import Palletize
from pydantic import Field
from rclpy.executors import ExternalShutdownException

from pack_bringup.graph.graph import load_graph
from pack_bringup.ros.goal_client import GoalClient, follow_goal
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.params import read_parameters

PATIENCE = 3.0
"""For nodes to be found before one says that they are not there [s of wall clock]."""


class OrderConfig(Config):
    """The goal."""

    file: str = Field(default="", description="an order's file")
    profile: str = Field(default="", description="blended or thesis; empty: as the machine's node has it")


class OrderNode(GoalClient):
    """Its order is in its parameters."""

    def __init__(self, **kwargs: Any) -> None:
        names = [node.name for node in load_graph("palletizing").nodes]
        super().__init__(contracts.PALLETIZE, Palletize.Goal(), names, **kwargs)
        config = read_parameters(self, OrderConfig)
        self.goal = Palletize.Goal(file=str(Path(config.file).resolve()), profile=config.profile)


class Patience:
    """Says once what is waited for, when it takes long."""

    def __init__(self) -> None:
        self._since: float | None = time.monotonic()

    def __call__(self, node: GoalClient) -> None:
        """Look whether the cell is complete."""
        if self._since is None or not node.missing or time.monotonic() < self._since + PATIENCE:
            return
        self._since = None
        sys.stderr.write(f"waiting for {', '.join(node.missing)}: `pack up palletizing` starts the cell\n")


def main() -> int:
    """Send one order to the cell that is running; 0 if its pallet is complete."""
    try:
        result = follow_goal(OrderNode, Patience())
    except PackError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    except (KeyboardInterrupt, ExternalShutdownException):
        return 1
    if result.boxes:
        sys.stdout.write(f"{result.placed} of {result.boxes} boxes placed\n")
    if result.message:
        sys.stderr.write(f"error: {result.message}\n")
    return 0 if result.success else 1
