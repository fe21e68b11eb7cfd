import pytest

from pack_bringup.graph import running
from pack_bringup.graph.running import cell_of, check_domain_is_free, described, free_domain
from pack_core.errors import PackError

PACKING = {"sim", "perception", "planner", "mpc", "recorder"}


def test_a_domain_in_which_nothing_runs_is_free() -> None:
    check_domain_is_free(3, "packing", PACKING, {4: PACKING})


def test_the_cell_that_has_taken_a_domain_is_named_with_another_domain() -> None:
    with pytest.raises(PackError) as refused:
        check_domain_is_free(3, "blocks", {"sim"}, {3: PACKING})
    text = str(refused.value)
    assert "ROS domain 3 is taken: the packing cell (mpc, perception, planner, recorder, sim) runs" in text
    assert "--domain" in text


def test_the_same_cell_once_more_is_refused() -> None:
    with pytest.raises(PackError, match="the packing cell"):
        check_domain_is_free(3, "packing", PACKING, {3: PACKING})


def test_a_cell_may_be_started_in_parts() -> None:
    check_domain_is_free(3, "packing", {"perception"}, {3: {"sim", "recorder"}})


def test_one_node_twice_is_refused() -> None:
    with pytest.raises(PackError, match="taken"):
        check_domain_is_free(3, "packing", {"sim", "mpc"}, {3: {"sim"}})


def test_what_is_no_node_of_a_cell_takes_no_domain() -> None:
    check_domain_is_free(3, "packing", PACKING, {3: {"goal", "live", "turtle"}})


def test_nodes_that_several_cells_have_tell_no_cell() -> None:
    assert cell_of({"sim", "motion"}) == ""
    assert cell_of({"sim", "vision"}) == "palletizing"
    assert cell_of({"vision", "tags"}) == ""
    assert described({"sim"}) == "nodes of a cell (sim) run"


def test_the_domain_that_is_offered_is_one_that_nobody_uses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "is_free", lambda domain: domain != 2)
    assert free_domain({1: {"sim"}}) == 3
