"""`pack stop` and `pack resume` reach the driver of the cell that they are meant for."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import pytest
from std_srvs.srv import Trigger

from integration.harness import Graph
from pack_bringup.ros import arm_calls
from pack_bringup.ros.arm_calls import resume_arm, stop_arm
from pack_core.errors import PackError
from pack_core.ros.contracts.shared import RESUME_ARM, STOP_ARM


def called(graph: Graph, call: Callable[[int], None]) -> None:
    """Make a call while the graph's nodes are served."""
    with ThreadPoolExecutor(1) as pool:
        done = pool.submit(call, graph.context.get_domain_id())
        graph.wait_until(done.done)
        done.result()


def test_the_driver_is_told_to_stop_and_why_and_to_go_on(graph: Graph) -> None:
    reasons: list[str] = []
    is_free: list[bool] = [True, False]

    def stop(request: Any, response: Any) -> Any:
        reasons.append(request.reason)
        response.success = True
        return response

    def resume(_: Any, response: Trigger.Response) -> Trigger.Response:
        response.success = is_free.pop(0)
        response.message = "" if response.success else "two nodes send setpoints"
        return response

    graph.probe.create_service(STOP_ARM.type, STOP_ARM.name, stop)
    graph.probe.create_service(RESUME_ARM.type, RESUME_ARM.name, resume)
    called(graph, partial(stop_arm, "somebody is in the cell"))
    called(graph, resume_arm)
    assert reasons == ["somebody is in the cell"]
    with pytest.raises(PackError, match="the arm stays stopped: two nodes send setpoints"):
        called(graph, resume_arm)


def test_where_no_driver_is_up_that_is_said(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arm_calls, "PATIENCE", 0.2)
    with pytest.raises(PackError, match=r"^nobody serves /left/arm/stop in ROS domain \d+, namespace /left"):
        called(graph, lambda domain: stop_arm("", domain, "/left"))
