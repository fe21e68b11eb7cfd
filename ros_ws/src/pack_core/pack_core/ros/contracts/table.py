"""The wiring tables by cell.

Publishers, subscribers, the recorder, `pack wiring` and docs/reference/dataflow.md come from them.
"""

from __future__ import annotations

from sensor_msgs.msg import Image

from pack_core.cells import CELLS, cell_part
from pack_core.ros.contracts.contract import Contract, Kind, events_of

EVERYBODY = {"all", "user"}
"""Ends of a contract that are no node: every node, and whoever looks at the cell from outside."""


def wiring_of(cell: str) -> tuple[Contract, ...]:
    """The wiring table of a cell.

    Raises:
        ConfigError: there is no such cell.
    """
    table: tuple[Contract, ...] = cell_part(cell, "contracts")
    return table


def wiring_tables() -> dict[str, tuple[Contract, ...]]:
    """The wiring tables of all cells, by cell."""
    return {cell: wiring_of(cell) for cell in CELLS}


def recorded(cell: str, *, with_pictures: bool = False) -> tuple[Contract, ...]:
    """The topics of a cell that the recorder writes, among them the events of recorded services.

    Args:
        cell: one of `CELLS`.
        with_pictures: also those of the cameras' pictures, which are large.
    """
    return tuple(
        events_of(contract) if contract.kind is Kind.SERVICE else contract
        for contract in wiring_of(cell)
        if contract.recorded or (with_pictures and is_picture(contract))
    )


def is_picture(contract: Contract) -> bool:
    """Whether a contract is the topic of a camera's pictures, which are recorded on request."""
    return contract.type is Image


def nodes_of(cell: str) -> set[str]:
    """The nodes that a cell's table names."""
    ends = {name for contract in wiring_of(cell) for name in (*contract.sources, *contract.targets)}
    return ends - EVERYBODY


def goal_actions(cell: str) -> list[Contract]:
    """The actions of a cell of which a user sends goals; those of an arm's driver are the motion's."""
    actions = [contract for contract in wiring_of(cell) if contract.kind is Kind.ACTION]
    return [action for action in actions if "user" in action.sources]
