"""Topics that a node reads when it wants to, outside the executor."""

from __future__ import annotations

import threading
import time
from functools import partial

import pytest
import rclpy
from builtin_interfaces.msg import Time
from rclpy.event_handler import EventHandler
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from integration.harness import PATIENCE, Graph
from pack_core.errors import ConfigError
from pack_core.ros.contracts import shared
from pack_core.ros.health import IN_A_ROW
from pack_core.ros.node import CellNode
from pack_core.ros.stream import NodeThread, Stream, StreamReader, StreamWait

NUMBERS = shared.REAL_TIME_FACTOR


class ListeningNode(CellNode):
    """A node that does nothing by itself."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__("listening", **kwargs)


@pytest.fixture
def node(graph: Graph) -> ListeningNode:
    return graph.start(ListeningNode)


def send(graph: Graph, count: int) -> None:
    for k in range(count):
        graph.probe.send(NUMBERS, Float64(data=float(k)))


def test_messages_wait_until_they_are_taken_and_the_oldest_are_dropped(
    graph: Graph, node: ListeningNode
) -> None:
    stream = Stream(node, NUMBERS, depth=3)
    graph.connect(NUMBERS)
    taken: list[Float64] = []
    assert stream.take_all() == []
    send(graph, 5)
    graph.wait_until(lambda: taken.extend(stream.take_all()) or any(m.data == 4.0 for m in taken))
    assert [message.data for message in taken][-1] == 4.0
    assert stream.take_all() == []


def test_a_wait_ends_with_the_first_message_or_its_time(graph: Graph, node: ListeningNode) -> None:
    stream = Stream(node, NUMBERS)
    wait = StreamWait(node, (stream,))
    graph.connect(NUMBERS)
    began = time.monotonic()
    assert not wait.wait(0.05)
    assert 0.04 < time.monotonic() - began < PATIENCE
    send(graph, 1)
    assert wait.wait(PATIENCE)
    assert len(stream.take_all()) == 1


def test_a_reader_reads_while_the_executor_does_nothing(graph: Graph, node: ListeningNode) -> None:
    stream, is_complete = Stream(node, NUMBERS), threading.Event()
    read: list[Float64] = []

    def take() -> None:
        read.extend(stream.take_all())
        if len(read) == 10:
            is_complete.set()

    reader = StreamReader(node, (stream,), take, 0.05)
    graph.connect(NUMBERS)
    send(graph, 10)
    assert is_complete.wait(PATIENCE)
    reader.end()
    assert [message.data for message in read] == [float(k) for k in range(10)]


def test_a_reader_hears_of_a_publisher_before_it_reads_its_first_message(
    graph: Graph, node: ListeningNode
) -> None:
    heard: list[str | Float64] = []
    stream = Stream(node, NUMBERS, on_match=lambda: heard.append("match"))
    reader = StreamReader(node, (stream,), lambda: heard.extend(stream.take_all()), 0.05)
    other = rclpy.create_node("other", context=graph.context)
    publisher = other.create_publisher(NUMBERS.type, NUMBERS.name, NUMBERS.qos)
    graph.wait_until(lambda: "match" in heard)
    publisher.publish(Float64(data=1.0))
    graph.wait_until(lambda: Float64(data=1.0) in heard)
    assert heard.index("match") < heard.index(Float64(data=1.0))
    before = heard.count("match")
    other.destroy_node()
    graph.wait_until(lambda: heard.count("match") > before)
    reader.end()


def test_what_a_thread_raises_is_counted_and_named_and_the_thread_goes_on(
    graph: Graph, node: ListeningNode
) -> None:
    graph.failures_allowed = True
    turns, has_been_seen = 0, threading.Event()

    def fail_at_first() -> None:
        nonlocal turns
        turns += 1
        if turns <= IN_A_ROW:
            raise ValueError("the turn went wrong")
        has_been_seen.wait(PATIENCE)
        time.sleep(0.01)

    thread = NodeThread(node, fail_at_first, "failing")
    graph.wait_until(lambda: "in a row" in node.health.faults.get("failed failing", ""))
    has_been_seen.set()
    graph.wait_until(lambda: turns > IN_A_ROW and not node.health.faults)
    thread.end()
    assert node.health.counts["failed failing"] == IN_A_ROW
    assert "the turn went wrong" in node.health.last["failed failing"]


def test_simulated_time_is_that_of_the_last_tick_when_it_is_asked_for(graph: Graph) -> None:
    node = graph.start(ListeningNode, use_sim_time=True)
    graph.connect(shared.CLOCK)
    for sec in (3, 4, 5):
        graph.probe.send(shared.CLOCK, Clock(clock=Time(sec=sec)))
    graph.wait_until(lambda: node.get_clock().now().nanoseconds == 5_000_000_000)


def test_a_node_can_be_taken_off_simulated_time(graph: Graph) -> None:
    node = graph.start(ListeningNode, use_sim_time=True)
    graph.connect(shared.CLOCK)
    assert node.get_clock().now().nanoseconds == 0
    node.set_parameters([Parameter("use_sim_time", value=False)])
    assert abs(node.get_clock().now().nanoseconds * 1e-9 - time.time()) < 5.0


def test_time_that_runs_backwards_is_named_and_followed_and_negative_time_is_refused(graph: Graph) -> None:
    node = graph.start(ListeningNode, use_sim_time=True)
    graph.connect(shared.CLOCK)
    for sec, shown, refused in ((5, 5, 0), (-3, 5, 1), (2, 2, 2)):
        graph.probe.send(shared.CLOCK, Clock(clock=Time(sec=sec)))
        graph.wait_until(
            lambda shown=shown, refused=refused: (
                node.get_clock().now().nanoseconds == shown * 1_000_000_000
                and node.health.counts["refused /clock"] == refused
            )
        )
    assert "time went back from 5.000 s to 2.000 s" in node.health.last["refused /clock"]


def test_a_second_simulator_is_noticed_at_once_and_named(graph: Graph) -> None:
    node = graph.start(ListeningNode, use_sim_time=True)
    graph.connect(shared.CLOCK)
    second = rclpy.create_node("impostor", context=graph.context)
    clock = second.create_publisher(shared.CLOCK.type, shared.CLOCK.name, shared.CLOCK.qos)
    graph.wait_until(lambda: "/clock" in node.health.faults)
    assert "a second simulator: /clock is published by 'impostor'" in node.health.faults["/clock"]
    assert "'probe'" in node.health.faults["/clock"]
    second.destroy_publisher(clock)
    graph.wait_until(lambda: "/clock" not in node.health.faults)
    second.destroy_node()


def test_a_second_node_of_a_name_is_refused_where_names_are_unique(graph: Graph) -> None:
    node = graph.start(partial(CellNode, "planner"))
    graph.wait_until(lambda: node.is_up)
    with pytest.raises(ConfigError, match="a node 'planner' runs already in ROS domain"):
        graph.start(partial(CellNode, "planner"))
    graph.stop(node)
    graph.start(partial(CellNode, "planner"))


def test_nothing_waits_for_events_of_a_clock_that_nobody_reads(graph: Graph) -> None:
    """Fast DDS would wake the executor for every tick that was not taken: a node would use up a core."""
    node = graph.start(ListeningNode, use_sim_time=True)
    (ticks,) = (found for found in node.subscriptions if found.topic_name == "/clock")
    handlers = [found for found in node.waitables if isinstance(found, EventHandler)]
    of_ticks = [found for found in handlers if found in ticks.event_handlers]
    assert of_ticks  # rclpy's own, about publishers that do not fit
    assert not any(found.callback_group.can_execute(found) for found in of_ticks)
