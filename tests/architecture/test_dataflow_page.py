"""docs/reference/dataflow.md is what the wiring tables say."""

import re
from importlib import import_module
from types import ModuleType

import pytest

from pack_bringup.cli.wiring import wiring_page
from pack_bringup.graph.graph import load_graph
from pack_core.cells import CELLS
from pack_core.paths import project_root
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.contracts.table import wiring_of, wiring_tables

ACTIONS_OF_ITS_OWN = {"pallet_fsm": ("pallet_calibration",)}
"""Packages with an action that a package's node takes, and what that listens to meanwhile."""


def test_dataflow_page_equals_the_wiring_tables() -> None:
    page = (project_root() / "docs" / "reference" / "dataflow.md").read_text()
    assert page == wiring_page(wiring_tables()), "run: pack wiring --markdown > docs/reference/dataflow.md"


def test_dataflow_page_has_every_contract_and_tells_none_twice() -> None:
    rows = re.findall(r"^\| (/[^ ]+) \| (.*) \|$", wiring_page(wiring_tables()), re.MULTILINE)
    assert {name for name, _ in rows} == {contract.name for cell in CELLS for contract in wiring_of(cell)}
    assert {row for row in rows if rows.count(row) == len(CELLS)} == set()


@pytest.mark.parametrize("cell", CELLS)
def test_wiring_names_only_nodes_of_the_graph(cell: str) -> None:
    nodes = {node.name for node in load_graph(cell).nodes} | {"user", "all"}
    ends = {name for contract in wiring_of(cell) for name in (*contract.sources, *contract.targets)}
    assert ends <= nodes


@pytest.mark.parametrize("cell", CELLS)
def test_names_are_wired_once(cell: str) -> None:
    names = [contract.name for contract in wiring_of(cell)]
    assert sorted(names) == sorted(set(names))


@pytest.mark.parametrize("cell", CELLS)
def test_every_topic_states_its_qos_and_rate(cell: str) -> None:
    topics = [contract for contract in wiring_of(cell) if contract.kind.value == "topic"]
    assert topics
    assert [topic.name for topic in topics if topic.qos is None or not topic.rate] == []


@pytest.mark.parametrize("cell", CELLS)
def test_what_the_wiring_sends_to_a_node_is_named_in_the_code_of_its_package(cell: str) -> None:
    module = import_module(f"pack_core.ros.contracts.{cell}")
    constants = {value.name: name for name, value in vars(module).items() if isinstance(value, Contract)}
    package_of = {node.name: node.package for node in load_graph(cell).nodes}
    unheard = [
        (contract.name, node)
        for contract in wiring_of(cell)
        for node in set(contract.targets) & package_of.keys() - {"recorder"}
        if contract.name in constants
        and not any(_is_named(word, package_of[node]) for word in _words_for(contract, module))
    ]
    assert unheard == []


def _words_for(contract: Contract, module: ModuleType) -> list[str]:
    """The names in a module of a contract, and of the tables that have it."""
    return [
        name
        for name, value in vars(module).items()
        if value is contract or any(contract in row for row in _rows_of(value))
    ]


def _rows_of(value: object) -> list[tuple[object, ...]]:
    """The tuples that a name stands for: one, or those of a table."""
    return [row for row in (value.values() if isinstance(value, dict) else [value]) if isinstance(row, tuple)]


def _is_named(constant: str, package: str) -> bool:
    packages = (package, *ACTIONS_OF_ITS_OWN.get(package, ()))
    files = [
        file for name in packages for file in (project_root() / "ros_ws" / "src" / name / name).rglob("*.py")
    ]
    return any(re.search(rf"\b{constant}\b", file.read_text()) for file in files)
