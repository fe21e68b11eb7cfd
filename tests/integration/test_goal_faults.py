"""What ends a goal: a silent peer, a stop of the arm, a failure of the node, a second simulator."""

from __future__ import annotations

from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from pack_interfaces.msg import ArmState
from std_srvs.srv import Trigger

from integration.goal_rig import FAULT_TIME, Waiter, ended, refusal, send
from integration.harness import Graph
from pack_core.ros.contracts import shared
from pack_core.ros.node import CellNode


@pytest.fixture
def waiter(graph: Graph) -> Waiter:
    return graph.start(Waiter)


def test_a_peer_that_stays_silent_ends_the_goal_and_new_goals_are_refused_until_it_is_back(
    graph: Graph, waiter: Waiter
) -> None:
    def make(**kwargs: Any) -> CellNode:
        return CellNode("sim", **kwargs)

    peer = graph.start(make)
    graph.wait_until(lambda: waiter.hears("sim"))
    handle = send(graph)
    graph.stop(peer)
    assert ended(graph, handle) == (GoalStatus.STATUS_ABORTED, "lost: sim")
    assert refusal(graph) == "silent: sim"
    graph.start(make)
    graph.wait_until(lambda: waiter.hears("sim"))
    send(graph)
    graph.wait_until(lambda: waiter.started == 2)


def test_a_peer_that_is_soon_heard_again_costs_nothing(graph: Graph, waiter: Waiter) -> None:
    handle = send(graph)
    graph.wait_until(lambda: waiter.started)
    waiter.on_peer("sim", is_alive=False)
    waiter.on_peer("sim", is_alive=True)
    with pytest.raises(AssertionError, match="in vain"):
        graph.result_of(handle, timeout=2.0 * FAULT_TIME)


class Driver(CellNode):
    """An arm's driver, as far as stops go."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sim", **kwargs)
        self._state, self.stops, self.is_stopped = self.advertise(shared.ARM_STATE), 0, False
        self.refusal = ""
        self.create_service(Trigger, shared.RESUME_ARM.name, self._on_resume)
        self.tell()

    def stop(self) -> None:
        self.stops, self.is_stopped = self.stops + 1, True
        self.tell()

    def release(self) -> None:
        self.is_stopped = False
        self.tell()

    def tell(self) -> None:
        reason = "a button" if self.is_stopped else ""
        self._state.publish(ArmState(is_stopped=self.is_stopped, reason=reason, stops=self.stops))

    def _on_resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success, response.message = self.is_stopped and not self.refusal, self.refusal
        if not self.refusal:
            self.release()
        return response


@pytest.fixture
def driver(graph: Graph, waiter: Waiter) -> Driver:
    node = graph.start(Driver)
    graph.wait_until(lambda: waiter.hears("sim"))
    graph.wait_until(lambda: node.count_subscribers(shared.ARM_STATE.name) > 0)
    return node


def test_a_stop_of_the_arm_ends_the_goal_once_and_the_next_goal_releases_it(
    graph: Graph, waiter: Waiter, driver: Driver
) -> None:
    handle = send(graph)
    driver.stop()
    assert ended(graph, handle) == (GoalStatus.STATUS_ABORTED, "the arm was stopped: a button")
    assert driver.is_stopped
    following = send(graph)
    graph.wait_until(lambda: waiter.started == 2)
    assert not driver.is_stopped
    driver.tell()
    waiter.end(True, "done")
    assert ended(graph, following) == (GoalStatus.STATUS_SUCCEEDED, "done")


def test_an_arm_whose_driver_does_not_release_it_gets_no_goal(
    graph: Graph, waiter: Waiter, driver: Driver
) -> None:
    driver.stop()
    graph.wait_until(lambda: waiter._arm_stops._arm.is_stopped)
    driver.refusal = "it must be cleared by hand"
    status, message = ended(graph, send(graph))
    assert status == GoalStatus.STATUS_ABORTED
    assert message == "the arm was stopped: a button, and was not released: it must be cleared by hand"
    assert waiter.started == 0


def test_a_stop_that_was_released_before_it_was_heard_of_ends_the_goal_all_the_same(
    graph: Graph, waiter: Waiter, driver: Driver
) -> None:
    handle = send(graph)
    graph.wait_until(lambda: waiter.started)
    driver.stops += 1
    driver.release()
    status, message = ended(graph, handle)
    assert status == GoalStatus.STATUS_ABORTED
    assert message == "the arm was stopped: and released at once"


def test_a_goal_that_was_accepted_before_the_stop_does_not_release_the_arm(
    graph: Graph, waiter: Waiter, driver: Driver, monkeypatch: pytest.MonkeyPatch
) -> None:
    release = waiter._arm_stops.release

    async def stopped_in_between() -> None:
        driver.stop()
        waiter._arm_stops._arm = ArmState(is_stopped=True, reason="a button", stops=1)
        await release()

    monkeypatch.setattr(waiter._arm_stops, "release", stopped_in_between)
    status, message = ended(graph, send(graph))
    assert (status, message) == (GoalStatus.STATUS_ABORTED, "the arm was stopped: a button")
    assert driver.is_stopped
    assert waiter.started == 0


def test_a_goal_ends_with_the_reason_when_a_callback_fails_and_the_next_is_taken(
    graph: Graph, waiter: Waiter
) -> None:
    graph.failures_allowed = True
    handle = send(graph)
    graph.wait_until(lambda: waiter.started)
    waiter.is_broken = True
    status, message = ended(graph, handle)
    assert status == GoalStatus.STATUS_ABORTED
    assert "timer _turn failed: ValueError('broken')" in message
    assert waiter.gave_up == 1
    waiter.is_broken = False
    send(graph)
    graph.wait_until(lambda: waiter.started == 2)


def test_a_pursuit_that_fails_in_a_way_that_nobody_foresaw_ends_the_goal_and_not_the_node(
    graph: Graph, waiter: Waiter
) -> None:
    graph.failures_allowed = True
    status, message = ended(graph, send(graph, "fail"))
    assert status == GoalStatus.STATUS_ABORTED
    assert "ZeroDivisionError" in message
    send(graph)
    graph.wait_until(lambda: waiter.started == 2)


def test_a_second_simulator_ends_the_goal_and_no_other_is_taken_until_it_has_gone(graph: Graph) -> None:
    node = graph.start(Waiter, use_sim_time=True)
    graph.connect(shared.CLOCK)
    handle = send(graph)
    graph.wait_until(lambda: node.started)
    second = rclpy.create_node("impostor", context=graph.context)
    clock = second.create_publisher(shared.CLOCK.type, shared.CLOCK.name, shared.CLOCK.qos)
    status, message = ended(graph, handle)
    assert status == GoalStatus.STATUS_ABORTED
    assert "a second simulator: /clock is published by 'impostor'" in message
    assert node.gave_up == 1
    assert "a second simulator" in refusal(graph)
    second.destroy_publisher(clock)
    graph.wait_until(lambda: "/clock" not in node.health.faults)
    send(graph)
    graph.wait_until(lambda: node.started == 2)
    second.destroy_node()
