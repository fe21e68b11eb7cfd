"""Nodes and a probe spun in this process, on a domain of their own."""

from __future__ import annotations

import itertools
import os
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import rclpy
from pack_interfaces.msg import NodeStatus
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.context import Context
from rclpy.event_handler import QoSPublisherEventType, QoSSubscriptionEventType
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

from pack_bringup.graph.running import DOMAINS, is_free
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.goal_node import REFUSED
from pack_core.ros.node import CellNode
from pack_core.ros.node_status import LISTENING
from pack_core.ros.stream import Stream

N = TypeVar("N", bound=Node)
PATIENCE = 30.0
"""What a condition may take to come true on a busy machine [s]; nothing waits longer than it has to."""
MAILBOX = 1000
"""Messages of a topic that may wait for the probe: a second of the fastest."""
ONLY_WARN = (
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS,
    QoSPublisherEventType.RCL_PUBLISHER_INCOMPATIBLE_TYPE,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE,
)
"""Events of which rclpy writes a line into the log."""
_numbers = itertools.count(7 * os.getpid())


def domains_of_worker(environment: Mapping[str, str]) -> range:
    """The domains that this process may use: an equal share for each worker, so that no two take the same."""
    workers = int(environment.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    worker = int(environment.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    return range(1, DOMAINS + 1)[worker::workers]


def own_domain() -> int:
    """The next of this worker's domains that no process of this machine is on."""
    domains = domains_of_worker(os.environ)
    candidates = (domains[n % len(domains)] for n in _numbers)
    return next(domain for domain in candidates if is_free(domain))


class Probe(Node):
    """Speaks for the nodes that a test leaves out, and keeps a mailbox per topic.

    It takes its messages itself: called back for each, it would take most of a test's processor time.
    """

    def __init__(self, context: Context) -> None:
        super().__init__("probe", context=context)
        self.mail: defaultdict[str, list[Any]] = defaultdict(list)
        self._streams: list[Stream] = []
        self._publishers_of: dict[str, Publisher] = {}
        self._clients_of: dict[str, Client] = {}

    def listen(self, *contracts: Contract) -> None:
        """Collect what is published, in `mail[topic]`, oldest first."""
        self._streams += [Stream(self, contract, depth=MAILBOX) for contract in contracts]

    def collect(self) -> None:
        """Put what has come into the mailboxes."""
        for stream in self._streams:
            self.mail[stream.contract.name] += stream.take_all()

    def last(self, contract: Contract) -> Any:
        """The newest message in a mailbox; None while it is empty."""
        mail = self.mail[contract.name]
        return mail[-1] if mail else None

    def publisher_of(self, contract: Contract) -> Publisher:
        """The probe's publisher of a topic."""
        if contract.name not in self._publishers_of:
            self._publishers_of[contract.name] = self.create_publisher(
                contract.type, contract.name, contract.qos
            )
        return self._publishers_of[contract.name]

    def send(self, contract: Contract, message: Any) -> None:
        """Publish a message; see `Graph.connect` for making sure that it is heard."""
        self.publisher_of(contract).publish(message)

    def silence(self, contract: Contract) -> None:
        """Publish a topic no longer, for one that has another publisher now."""
        self.destroy_publisher(self._publishers_of.pop(contract.name))

    def client_of(self, contract: Contract) -> Client:
        """The probe's client of a service."""
        if contract.name not in self._clients_of:
            self._clients_of[contract.name] = self.create_client(contract.type, contract.name)
        return self._clients_of[contract.name]


class Waits(SingleThreadedExecutor):
    """Waits for what is called back, not for events that rclpy only warns of.

    Every publisher and every subscription has some, more than there is of all else, and what is waited for is
    listed anew at each wait: with them a test of a whole cell takes a sixth more processor time.
    """

    def can_execute(self, entity: Any) -> bool:
        """Whether to wait for an entity."""
        return getattr(entity, "event_type", None) not in ONLY_WARN and super().can_execute(entity)


class Graph:
    """Nodes under test and a probe in one executor; nothing runs but in `wait_until` and what calls it.

    Args:
        domain: where processes run that the test talks to; None: one that nobody is on.

    Attributes:
        failures_allowed: whether callbacks of the nodes may fail in a way that nobody foresaw.
    """

    def __init__(self, domain: int | None = None) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=own_domain() if domain is None else domain)
        self.executor = Waits(context=self.context)
        self.probe = Probe(self.context)
        self._nodes: list[Node] = []
        self.failures_allowed = False
        self._add(self.probe)

    def start(self, make: Callable[..., N], **parameters: Any) -> N:
        """Build a node with parameters of its own and let it run."""
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        node = make(context=self.context, parameter_overrides=overrides)
        self._add(node)
        return node

    def stop(self, node: Node) -> None:
        """Take one node out of the graph, as if its process had ended."""
        self._nodes.remove(node)
        self.executor.remove_node(node)
        node.destroy_node()

    def wait_until(self, condition: Callable[[], object], timeout: float = PATIENCE) -> None:
        """Spin until the condition holds.

        Raises:
            AssertionError: it did not within `timeout` [s], or a callback of a node failed, which the node
                itself survives.
        """
        deadline = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < deadline, f"waited {timeout} s in vain"
            self.spin_once(0.02)

    def spin_once(self, timeout: float) -> None:
        """Call one callback, waiting up to `timeout` [s] for it, and put into the mailboxes what has come.

        Raises:
            AssertionError: a callback of a node failed, which the node itself survives.
        """
        self.executor.spin_once(timeout_sec=timeout)
        self.probe.collect()
        self._check_failures()

    def connect(self, *contracts: Contract, subscribers: int = 1) -> None:
        """Wait until what the probe sends on these topics has at least so many listeners."""
        publishers = [self.probe.publisher_of(contract) for contract in contracts]
        self.wait_until(lambda: all(p.get_subscription_count() >= subscribers for p in publishers))

    def call(self, contract: Contract, request: Any, timeout: float = PATIENCE) -> Any:
        """Call a service and return its response."""
        client = self.probe.client_of(contract)
        self.wait_until(client.service_is_ready)
        future = client.call_async(request)
        self.wait_until(future.done, timeout)
        return future.result()

    def send_goal(self, contract: Contract, goal: Any, feedback: Callable[[Any], None] | None = None) -> Any:
        """Send an action's goal and return its handle."""
        client = ActionClient(self.probe, contract.type, contract.name)
        self.wait_until(client.server_is_ready)
        future = client.send_goal_async(goal, feedback_callback=feedback)
        self.wait_until(future.done)
        return future.result()

    def result_of(self, handle: Any, timeout: float = 60.0) -> Any:
        """Wait for the result of an accepted goal."""
        future = handle.get_result_async()
        self.wait_until(future.done, timeout)
        return future.result().result

    def wait_until_ready(self, *names: str, timeout: float = PATIENCE) -> None:
        """Spin until nodes have said that they are ready."""
        ready: set[str] = set()

        def note(status: NodeStatus) -> None:
            ready.add(status.name) if status.state == NodeStatus.READY else ready.discard(status.name)

        topic = shared.NODE_STATUS
        listening = self.probe.create_subscription(topic.type, topic.name, note, LISTENING)
        self.wait_until(lambda: ready >= set(names), timeout)
        self.probe.destroy_subscription(listening)

    def refusal(self, contract: Contract, goal: Any) -> str:
        """Send a goal that is not taken; the reason that the sender is told."""
        message = str(self.result_of(self.send_goal(contract, goal), PATIENCE).message)
        assert message.startswith(REFUSED), message
        return message.removeprefix(REFUSED)

    def close(self) -> None:
        """End all nodes and the domain."""
        self.executor.shutdown()
        for node in reversed(self._nodes):
            node.destroy_node()
        rclpy.try_shutdown(context=self.context)

    def _check_failures(self) -> None:
        nodes = [node for node in self._nodes if isinstance(node, CellNode)]
        failed = {node.get_name(): node.health.last for node in nodes if node.failures.total}
        assert self.failures_allowed or not failed, f"callbacks have failed: {failed}"

    def _add(self, node: Node) -> None:
        self._nodes.append(node)
        self.executor.add_node(node)
