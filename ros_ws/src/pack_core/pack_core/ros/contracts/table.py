"""The wiring tables by cell.

Publishers, subscribers, the recorder, `pack wiring` and docs/dataflow.md come from them.
"""

from __future__ import annotations

from pack_core.errors import ConfigError
from pack_core.ros.contracts import blocks, packing, palletizing
from pack_core.ros.contracts.contract import Contract

WIRING = {"packing": packing.CONTRACTS, "palletizing": palletizing.CONTRACTS, "blocks": blocks.CONTRACTS}


def wiring_of(cell: str) -> tuple[Contract, ...]:
    """The wiring table of a cell; raises ConfigError where there is no such cell."""
    if cell not in WIRING:
        raise ConfigError(f"no wiring table for cell '{cell}'; there are: {', '.join(WIRING)}")
    return WIRING[cell]


def recorded(cell: str) -> tuple[Contract, ...]:
    """The topics of a cell that the recorder writes."""
    return tuple(contract for contract in wiring_of(cell) if contract.recorded)


def nodes_of(cell: str) -> set[str]:
    """The nodes that a cell's table names."""
    ends = {name for contract in wiring_of(cell) for name in (*contract.sources, *contract.targets)}
    return ends - {"all", "user"}
