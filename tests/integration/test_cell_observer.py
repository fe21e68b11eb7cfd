"""What sends goals to a cell for hours leaves nothing behind in it, and waits for no node that has ended."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from pack_interfaces.action import Palletize
from std_srvs.srv import Trigger

from integration.goal_rig import ACTION, Waiter
from integration.harness import Graph
from pack_bringup.robustness.ros.cell_observer import CellObserver
from pack_core.errors import PackError
from pack_core.ros.contracts.contract import Contract, Kind

RESET = Contract("/start_over", Trigger, ("user",), ("sim",), "begin anew", kind=Kind.SERVICE)
SENDING = f"{ACTION.name}/_action/send_goal"


class Quick(Waiter):
    """Its goals end at once."""

    async def pursue(self, request: Palletize.Goal) -> Palletize.Result:
        self.started += 1
        return Palletize.Result(success=True, message=request.order)


class Order:
    """A goal with a scene before it."""

    def __init__(self, number: int) -> None:
        self._number = number

    def reset(self) -> tuple[Contract, Any]:
        return RESET, Trigger.Request()

    def goal(self) -> tuple[Contract, Any]:
        return ACTION, Palletize.Goal(order=str(self._number))


def begin_anew(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
    response.success = True
    return response


def test_goal_after_goal_is_sent_by_one_client_alone(graph: Graph) -> None:
    # Every node remembers each client that ever came, so that a new one for each goal would grow them all.
    node = graph.start(Quick)
    graph.probe.create_service(Trigger, RESET.name, begin_anew)

    def results(observer: CellObserver) -> list[str]:
        ended = []
        for number in range(3):
            observer.send(Order(number))
            assert observer.spin_until(lambda: observer.result is not None, 20.0)
            ended.append(observer.result.message)
        return ended

    with CellObserver("packing", graph.context.get_domain_id()) as observer, ThreadPoolExecutor(1) as pool:
        sent = pool.submit(results, observer)
        graph.wait_until(sent.done)
        assert sent.result() == ["0", "1", "2"]
        assert node.started == 3
        assert graph.probe.count_clients(RESET.name) == 1
        assert graph.probe.count_clients(SENDING) == 1


def test_a_node_that_ended_is_not_waited_for(graph: Graph) -> None:
    with (
        CellObserver("packing", graph.context.get_domain_id()) as observer,
        pytest.raises(PackError, match="not ready: sim ended with exit code 1"),
    ):
        observer.await_ready(["sim", "mpc"], lambda: {"sim": 1})
