"""Cells in namespaces: which may share a domain, and how their nodes are started."""

import pytest

from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.running import check_domain_is_free
from pack_core.cells import CELLS
from pack_core.errors import ConfigError, PackError
from pack_core.namespace import ROOT, below, checked_namespace
from pack_core.ros.contracts.table import wiring_of


def test_a_domain_is_shared_by_namespaces_and_not_within_one() -> None:
    running = {3: {"left/sim", "left/motion", "turtle"}}
    names = [node.name for node in load_graph("blocks").nodes]
    check_domain_is_free(3, "blocks", names, running, namespace="/right")
    check_domain_is_free(3, "blocks", names, running)
    with pytest.raises(PackError, match=r"domain 3, namespace /left is taken: .*motion, sim.*--namespace"):
        check_domain_is_free(3, "blocks", names, running, namespace="/left")


@pytest.mark.parametrize("cell", CELLS)
def test_nodes_in_a_namespace_are_told_what_their_files_have(cell: str) -> None:
    """A parameter file is of the node that its key names, which is in no namespace."""
    for node in load_graph(cell).nodes:
        command = node.command({"preset": "x"}, "/left")
        assert "__ns:=/left" in command
        assert "--params-file" not in command
        assert "preset:=x" in command
    assert "real_time_factor:=1.0" in load_graph("blocks").nodes[0].command(namespace="/left")


def test_namespaces_are_written_with_or_without_a_slash_and_others_refused() -> None:
    assert [checked_namespace(given) for given in ("", "/", "left", "/hall/left/")] == [
        ROOT, ROOT, "/left", "/hall/left",
    ]  # fmt: skip
    assert below("/left", "/tf") == "/left/tf"
    assert below("/left", "tf") == "tf"
    for wrong in ("2nd", "left-hand", "a//b", "left right"):
        with pytest.raises(ConfigError, match="allowed: letters"):
            checked_namespace(wrong)


@pytest.mark.parametrize("cell", CELLS)
def test_every_name_of_the_wiring_tables_can_be_put_into_a_namespace(cell: str) -> None:
    assert [contract.name for contract in wiring_of(cell) if not contract.name.startswith("/")] == []
