"""Messages that no node expects, on every topic that the packing cell hears: nobody dies of them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import pytest

from integration.harness import Graph
from integration.packing.cell_rig import Cell
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract, Kind
from pack_core.ros.node import CellNode

NODES = ("sim", "perception", "planner", "mpc")
FLOATS = (float("nan"), float("inf"), -1e308, 1e-300, 0.0)
TEXTS = ("", "x" * 1000, "a: &a [*a, *a]", "\x1b[2J")
VARIANTS = max(len(FLOATS), len(TEXTS))


@pytest.fixture
def cell(graph: Graph) -> Cell:
    return Cell(graph, 0.3)


def extremes_of(contract: Contract) -> list[Any]:
    """An empty message, and some with every field at an extreme of its type; lists have two items."""
    return [contract.type(), *(filled(contract.type, k) for k in range(VARIANTS))]


def filled(kind: Any, k: int) -> Any:
    """The k-th message of a type."""
    message = kind()
    for name, field_type in message.get_fields_and_field_types().items():
        is_list, is_fixed = field_type.startswith("sequence<"), "[" in field_type
        inner = field_type.removeprefix("sequence<").rstrip(">").split("[")[0].split(",")[0]
        value = extreme(inner, k)
        if value is None:
            continue
        if is_fixed:
            value = [value] * len(getattr(message, name))
        setattr(message, name, [value, value] if is_list else value)
    return message


def extreme(field_type: str, k: int) -> Any:
    """The k-th extreme value of a field's type; None for a type that has none."""
    if field_type in ("double", "float"):
        return (
            FLOATS[k % len(FLOATS)] if field_type == "double" else float(min(max(FLOATS[k % 5], -1e30), 1e30))
        )
    if field_type == "string":
        return TEXTS[k % len(TEXTS)]
    if field_type == "boolean":
        return bool(k % 2)
    if field_type.startswith(("int", "uint")):
        bits = int(field_type.lstrip("uint"))
        least, most = (
            (0, 2**bits - 1) if field_type.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        )
        return (least, most, 1)[k % 3]
    if "/" in field_type:
        package, _, name = field_type.rpartition("/")
        return filled(getattr(import_module(f"{package.split('/')[0]}.msg"), name), k)
    return None


def heard_topics() -> list[Contract]:
    return [
        contract
        for contract in contracts.CONTRACTS
        if contract.kind is Kind.TOPIC and set(contract.targets) & {*NODES, "all"}
    ]


def failures_of(node: CellNode) -> dict[str, str]:
    return {what: why for what, why in node.health.last.items() if what.startswith("failed ")}


def test_no_message_on_any_topic_ends_a_node_or_its_service(cell: Cell) -> None:
    graph = cell.graph
    graph.failures_allowed = True  # an error that nobody foresaw is no end; the next test counts them
    nodes: tuple[CellNode, ...] = (cell.sim, cell.perception, cell.planner, cell.mpc)
    for contract in heard_topics():
        for message in extremes_of(contract):
            graph.probe.send(contract, message)
            graph.spin_once(0.002)
        graph.probe.silence(contract)
    for node in nodes:
        reports = len(graph.probe.mail[shared.DIAGNOSTICS.name])
        node.report()
        graph.wait_until(lambda reports=reports: len(graph.probe.mail[shared.DIAGNOSTICS.name]) > reports)
    failed = {
        node.get_name(): {k: v for k, v in node.health.last.items() if k.startswith("failed")}
        for node in nodes
    }
    assert not any(failed.values()), f"errors that nobody foresaw: {failed}"
