"""The thread in which a simulator's physics run."""

from __future__ import annotations

from typing import Any

import pytest

from integration.harness import Graph
from pack_sim.packing.sim_node import PackingSimNode


def test_a_report_of_the_pace_that_fails_does_not_end_the_physics(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    graph.failures_allowed = True
    node = graph.start(PackingSimNode)
    failed_at: list[float] = []

    def fail(_: Any) -> None:
        failed_at.append(node.simulator.time)
        raise RuntimeError("the middleware is gone")

    monkeypatch.setattr(node._factor, "publish", fail)
    graph.wait_until(lambda: failed_at)
    monkeypatch.undo()
    graph.wait_until(lambda: node.simulator.time > failed_at[-1] + 0.1)
