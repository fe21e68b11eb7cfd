"""docs/dataflow.md is what the wiring table says."""

from pack_bringup.graph import load_graph
from pack_bringup.wiring import wiring_page
from pack_core.paths import project_root
from pack_core.ros.contracts import CONTRACTS


def test_dataflow_page_equals_the_wiring_table() -> None:
    page = (project_root() / "docs" / "dataflow.md").read_text()
    assert page == wiring_page(CONTRACTS), "run: pack wiring --markdown > docs/dataflow.md"


def test_wiring_names_only_nodes_of_the_graph() -> None:
    nodes = {node.name for node in load_graph("packing").nodes} | {"user", "all"}
    ends = {name for contract in CONTRACTS for name in (*contract.sources, *contract.targets)}
    assert ends <= nodes


def test_names_are_wired_once() -> None:
    names = [contract.name for contract in CONTRACTS]
    assert sorted(names) == sorted(set(names))


def test_every_topic_states_its_qos_and_rate() -> None:
    topics = [contract for contract in CONTRACTS if contract.kind.value == "topic"]
    assert topics
    assert [topic.name for topic in topics if topic.qos is None or not topic.rate] == []
