"""The packing cell as a node is told of it."""

from __future__ import annotations

from rclpy.node import Node

from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.ros.params import read_only


def read_packing_cell(node: Node) -> PackingCell:
    """The configured cell, under what the node's parameter `cell` lays over it.

    Raises:
        ConfigError: the parameter has a key or value that is not allowed.
    """
    descriptor = read_only("YAML text that lies over config/cells/packing.yaml")
    return packing_cell(node.declare_parameter("cell", "{}", descriptor).value)
