"""The harness itself: two graphs never hear each other, and waiting in vain fails."""

from __future__ import annotations

import pytest
from std_msgs.msg import Float64

from integration.harness import Graph, domains_of_worker
from pack_bringup.graph.running import DOMAINS
from pack_core.ros.contracts import shared


def test_probe_hears_itself_and_no_other_graph(graph: Graph) -> None:
    other = Graph()
    try:
        for each in (graph, other):
            each.probe.listen(shared.REAL_TIME_FACTOR)
            each.connect(shared.REAL_TIME_FACTOR)
        graph.probe.send(shared.REAL_TIME_FACTOR, Float64(data=2.0))
        other.probe.send(shared.REAL_TIME_FACTOR, Float64(data=3.0))
        for each in (graph, other):
            each.wait_until(lambda each=each: each.probe.last(shared.REAL_TIME_FACTOR))
        assert [m.data for m in graph.probe.mail[shared.REAL_TIME_FACTOR.name]] == [2.0]
        assert [m.data for m in other.probe.mail[shared.REAL_TIME_FACTOR.name]] == [3.0]
    finally:
        other.close()


def test_waiting_in_vain_fails(graph: Graph) -> None:
    with pytest.raises(AssertionError, match="in vain"):
        graph.wait_until(lambda: False, timeout=0.05)


def test_no_two_workers_share_a_domain_and_none_is_left_out() -> None:
    count = {"PYTEST_XDIST_WORKER_COUNT": "3"}
    shares = [set(domains_of_worker({"PYTEST_XDIST_WORKER": f"gw{k}", **count})) for k in range(3)]
    assert sum(map(len, shares)) == len(set().union(*shares)) == DOMAINS
    assert set(domains_of_worker({})) == set().union(*shares)
