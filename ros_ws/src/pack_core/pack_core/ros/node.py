"""Base of every node: parameters, endpoints whose callbacks may fail, clock, sign of life, and its peers."""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from pydantic import BaseModel
from rcl_interfaces.msg import SetParametersResult
from rclpy.client import Client
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.service_introspection import ServiceIntrospectionState
from rclpy.subscription import Subscription
from rclpy.time_source import TimeSource
from rclpy.timer import Timer

from pack_core.errors import ConfigError, PackError
from pack_core.namespace import in_cell, lifeline
from pack_core.ros.clock import SimulatedTime, TakenByHand
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract, events_of
from pack_core.ros.health import Failures, Health
from pack_core.ros.node_status import NodeStatusPublisher
from pack_core.ros.params import ParameterSet, unknown, unknown_parameters
from pack_core.ros.sole_publisher import SolePublisher
from pack_core.ros.watch.local_nodes import check_name_is_free
from pack_core.ros.watch.peer_watch import PeerWatch, SignOfLife, SilenceLog
from pack_core.ros.watch.watch_socket import WatchSocket

C = TypeVar("C", bound=BaseModel)

ASSERTION_PERIOD = 0.05
"""How often a node says that it is alive [s of wall clock]: ten times within the lease, as some come late."""
READINESS_PERIOD = 0.1
"""How often a node that has just started looks whether it is ready [s of wall clock]."""
BEATS_BETWEEN_LOOKS = 4
"""Signs of life from one look for a second simulator to the next: five looks a second."""


class CellNode(Node):
    """A node of a cell, or one that talks to a cell. Its health is published on /diagnostics once a second.

    - **Parameters** are the fields of a configuration class (`read_parameters`): what that refuses is
      refused, with the reason.
    - **Callbacks** may raise. A PackError means that a message was refused: it is dropped, counted and named.
      Any other error was not foreseen: it is counted and named, too, and `on_failure` is called, because what
      the callback worked on may be broken.
    - **The clock** is read when somebody asks for the time, and a second simulator is noticed.
    - **Peers** hear its sign of life, and it watches those that it is told of (`watch`).

    Attributes:
        may_be_repeated: whether a domain may have several nodes of its name.
        health: what was refused and what is wrong.
        failures: the errors that nobody foresaw.
        wall: a clock of wall time that never jumps, for timers that must not wait for simulated time.
        parameter_set: the configuration that `read_parameters` has read, if it has.
    """

    may_be_repeated = False
    parameter_set: ParameterSet[Any] | None = None
    _simulated_time: SimulatedTime | None = None
    _sole_clock: SolePublisher | None = None

    def __init__(self, name: str, **kwargs: Any) -> None:
        # First, because rclpy's constructor creates services.
        self.health = Health(name)
        self.failures = Failures(self.health, self.get_logger)
        super().__init__(name, **kwargs)
        self.wall = Clock(clock_type=ClockType.STEADY_TIME)
        if not self.may_be_repeated:
            check_name_is_free(self.context.get_domain_id(), self.lifeline(self.get_name()))
        self._diagnostics = self.advertise(shared.DIAGNOSTICS)
        self._status_publisher = NodeStatusPublisher(self)
        self._silences = SilenceLog(self.get_logger())
        self.create_timer(1.0, self._look_around, clock=self.wall)
        self._ended = threading.Event()
        self._watch_socket: WatchSocket | None = None
        self._watches: list[PeerWatch] = []
        self._heart: threading.Thread | None = None
        # Not guarded: a node that was configured wrongly ends here.
        self._birth = super().create_timer(0.001, self._come_alive, clock=self.wall)
        self._readiness = self.create_timer(READINESS_PERIOD, self._look_whether_ready, clock=self.wall)

    # What a subclass says of itself

    @property
    def waits_for(self) -> str:
        """What the node needs of others before it can do its work, in words; empty: it is ready."""
        return ""

    @property
    def is_busy(self) -> bool:
        """Whether the node pursues a goal."""
        return False

    def on_failure(self, reason: str) -> None:
        """A callback failed in a way that nobody foresaw: a commanding node stops. The executor calls it."""

    def on_peer_end(self, peer: str) -> None:
        """A process of a watched peer has ended, and what it knew is lost; called from another thread."""

    # Parameters

    def read_parameters(self, cls: type[C], on_change: Callable[[C], None] | None = None) -> C:
        """Declare every field of `cls` as a parameter and return the validated configuration.

        Nested configuration classes become dotted names; a section that may be None is there as soon as
        one of its parameters is given.

        Args:
            cls: the configuration; a field marked `Changeable` may be set while the node runs.
            on_change: takes the configuration with a new value; a PackError that it raises refuses the value.
                Needed as soon as a field is changeable.

        Raises:
            ConfigError: a parameter has a value that is not allowed.
        """
        parameters = self.parameter_set = ParameterSet(self, cls, on_change)
        return parameters.config

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Put new values of parameters in force, all or none; what is refused is refused with the reason."""
        try:
            for parameter in parameter_list:
                if not self.has_parameter(parameter.name):
                    raise ConfigError(f"no parameter {unknown(self, parameter.name)}")
            if self.parameter_set is None:
                raise ConfigError(f"node '{self.get_name()}' reads its parameters only when it starts")
            stored, when = self.parameter_set.change(parameter_list)
        except PackError as error:
            return SetParametersResult(successful=False, reason=str(error))
        result = super().set_parameters_atomically(stored)
        if result.successful:
            result.reason = f"counts {when}"
            self.get_logger().info(", ".join(f"{item.name} is {item.value}" for item in stored) + f", {when}")
        return result

    # Endpoints from the wiring table, whose callbacks may raise without ending the node

    def in_cell(self, name: str) -> str:
        """A name of the wiring table, or of another node of the cell, below the namespace of this one.

        The table's names begin with a slash, as recordings have them; a cell in a namespace has all of them
        there, `/tf` and `/clock` included, so that two cells of one domain share nothing.
        """
        return in_cell(self.get_namespace(), name)

    def lifeline(self, name: str) -> str:
        """By which name a node of this cell is known on this machine."""
        return lifeline(self.get_namespace(), name)

    def create_publisher(self, msg_type: Any, topic: str, *args: Any, **kwargs: Any) -> Publisher:
        """As of every node, for a topic of the wiring table."""
        return super().create_publisher(msg_type, self.in_cell(topic), *args, **kwargs)

    def create_client(self, srv_type: Any, srv_name: str, **kwargs: Any) -> Client:
        """As of every node, for a service of the wiring table."""
        return super().create_client(srv_type, self.in_cell(srv_name), **kwargs)

    def advertise(self, contract: Contract) -> Publisher:
        """A publisher of the contract's topic."""
        return self.create_publisher(contract.type, contract.name, contract.qos)

    def listen(self, contract: Contract, callback: Callable[[Any], None], **kwargs: Any) -> Subscription:
        """A subscription that drops, counts and reports a message its callback refuses."""
        guarded = partial(self.guard, contract, callback)
        return self.create_subscription(contract.type, contract.name, guarded, contract.qos, **kwargs)

    def guard(self, contract: Contract, callback: Callable[[Any], None], message: Any) -> None:
        """Pass a message on; drop, count and report it if `callback` refuses it or fails."""
        try:
            callback(message)
        except PackError as error:
            self.health.count(f"refused {contract.name}", str(error))
            self.get_logger().warning(f"refused {contract.name}: {error}", throttle_duration_sec=1.0)
        except Exception as error:
            self.fail(contract.name, error)
        else:
            self.failures.passed(contract.name)

    def offer(self, contract: Contract, serve: Callable[..., Any]) -> Service:
        """The contract's service; where it is recorded, its requests and answers are told on a topic."""
        service = self.create_service(contract.type, contract.name, serve)
        if contract.recorded:
            events = events_of(contract)
            assert events.qos is not None
            service.configure_introspection(self.get_clock(), events.qos, ServiceIntrospectionState.CONTENTS)
        return service

    def create_timer(self, period: float, callback: Callable[[], None], *args: Any, **kwargs: Any) -> Timer:
        """As of every node, but what the callback raises does not end it."""
        where = f"timer {getattr(callback, '__name__', callback)}"
        return super().create_timer(period, partial(self._call_guarded, where, callback), *args, **kwargs)

    def create_service(self, srv_type: Any, name: str, serve: Callable[..., Any], **kwargs: Any) -> Service:
        """As of every node, but a request that fails is answered, with the reason, and does not end it."""
        guarded = partial(self._serve_guarded, name, serve)
        return super().create_service(srv_type, self.in_cell(name), guarded, **kwargs)

    def fail(self, where: str, error: Exception) -> None:
        """Count and name an error that nobody foresaw, raised in `where`; any thread may call it."""
        if not self.context.ok():
            return  # the process is ending: what is raised now has lost its middleware
        self.failures.note(where, error)
        self.react_to_failure(f"{where} failed: {error!r}")

    def react_to_failure(self, reason: str) -> None:
        """Have `on_failure` called by the executor; whoever noticed the failure may hold a lock."""
        if self.executor is not None:
            self.executor.create_task(self._call_on_failure, reason)

    def _call_on_failure(self, reason: str) -> None:
        try:
            self.on_failure(reason)
        except Exception as error:  # what shall put the node in order must not stop it, either
            self.failures.note("what follows a failure", error)

    def _call_guarded(self, where: str, callback: Callable[[], None]) -> None:
        try:
            callback()
        except Exception as error:
            self.fail(where, error)
        else:
            self.failures.passed(where)

    def _serve_guarded(self, name: str, serve: Callable[[Any, Any], Any], request: Any, response: Any) -> Any:
        try:
            answer = serve(request, response)
        except Exception as error:
            self.fail(name, error)
            failed = type(response)()
            if hasattr(failed, "message"):
                failed.message = f"{name} failed: {error!r}; the node's log says more"
            return failed
        self.failures.passed(name)
        return answer

    # The clock

    def create_subscription(self, msg_type: Any, topic: str, callback: Any, *args: Any, **kwargs: Any) -> Any:
        """As of every node, but that of rclpy to /clock costs nothing until somebody asks for the time."""
        is_clock = isinstance(getattr(callback, "__self__", None), TimeSource)
        if is_clock:
            kwargs["callback_group"] = TakenByHand()
        subscription = super().create_subscription(msg_type, self.in_cell(topic), callback, *args, **kwargs)
        if is_clock:
            self._simulated_time = SimulatedTime(subscription, self._note_tick)
            self._sole_clock = SolePublisher(self, subscription.topic_name, self._on_clocks)
        return subscription

    def get_clock(self) -> Any:
        """The node's clock; under `use_sim_time` it is set to the last /clock now.

        A timer must not use it, as nobody sets it in between: `wall` is for timers.
        """
        if self._simulated_time is not None:
            self._simulated_time.update()
        return super().get_clock()

    def _note_tick(self, trouble: str) -> None:
        self.health.count(f"refused {shared.CLOCK.name}", trouble)
        self.get_logger().warning(f"{shared.CLOCK.name}: {trouble}", throttle_duration_sec=1.0)

    def _look_at_clocks(self) -> None:
        if self._sole_clock is not None:
            self._sole_clock.check()

    def _on_clocks(self, publishers: str) -> None:
        """While there are two clocks no stamp can be trusted: whoever commands the arm stops."""
        if not publishers:
            self.health.faults.pop(shared.CLOCK.name, None)
            return
        trouble = self.health.faults[shared.CLOCK.name] = f"a second simulator: {publishers}; end one of them"
        self.get_logger().error(trouble)
        self.react_to_failure(trouble)

    # Life: from the first sign to the end, and what others are told of it

    @property
    def is_up(self) -> bool:
        """Whether the node has said that it is alive: its configuration was in order."""
        return self._heart is not None

    def tell_status(self) -> None:
        """Say on /node_status where the node stands, if that has changed; to be called from the executor."""
        if self.is_up:  # before that its configuration may still turn out to be wrong
            self._status_publisher.publish("" if self.is_busy else self.waits_for, is_busy=self.is_busy)

    def report(self) -> None:
        """Publish this node's health on /diagnostics."""
        message = DiagnosticArray(status=[self.health.status()])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)

    def destroy_node(self) -> None:
        """Stop saying that the node is alive, then end."""
        self._ended.set()
        if self._heart is not None:
            self._heart.join()
        for watch in self._watches:
            watch.end()
        super().destroy_node()
        if self._watch_socket is not None:
            self._watch_socket.close()

    def _come_alive(self) -> None:
        """Say for the first time that the node is alive, in the executor's first turn.

        Not in the constructor: what a subclass builds there may take longer than the lease, and the node
        would be taken for dead before it has begun.
        """
        self._birth.cancel()
        if said := unknown_parameters(self):
            raise ConfigError(f"node '{self.get_name()}' has no parameter {', and none '.join(said)}")
        self._watch_socket = WatchSocket(self.context.get_domain_id(), self.lifeline(self.get_name()))
        sign = SignOfLife(self, self.get_name())
        self._heart = threading.Thread(target=self._beat, args=(sign,), name="alive", daemon=True)
        self._heart.start()
        for watch in self._watches:
            watch.begin()

    def _beat(self, sign: SignOfLife) -> None:
        # A thread, because a timer would wait for callbacks that compute for longer than the lease. What else
        # is to be done several times a second is done here, too: waking the executor for it takes a
        # millisecond of processor time.
        with suppress(InvalidHandle, RuntimeError):  # the context may end first
            for count in itertools.count():
                if self._ended.wait(ASSERTION_PERIOD) or not self.context.ok():
                    return
                sign.give()
                if count % BEATS_BETWEEN_LOOKS == 0:
                    self._call_guarded("the look at clocks", self._look_at_clocks)

    def _look_whether_ready(self) -> None:
        self.tell_status()
        if self._status_publisher.is_ready:
            self._readiness.cancel()

    def _look_around(self) -> None:
        self.tell_status()
        self._silences.write(self._watches, time.monotonic())
        self.report()

    # Peers

    def watch(self, peers: Iterable[str], on_change: Callable[[str, bool], None] | None = None) -> None:
        """Report peers that die; `on_change(peer, is_alive)` is called when one dies or comes (back)."""
        for peer in peers:
            watch = PeerWatch(self, peer, partial(self._on_peer_change, on_change), self._on_peer_end)
            if self._sole_clock is not None:
                self._sole_clock.track(peer)
            self._watches.append(watch)
            if self.is_up:
                watch.begin()

    def hears(self, peer: str) -> bool:
        """Whether a watched peer has been heard of, and not fallen silent since."""
        return any(watch.is_alive for watch in self._watches if watch.peer == peer)

    def _on_peer_end(self, peer: str) -> None:
        try:
            if self._sole_clock is not None:
                self._sole_clock.forget(peer)
            self.on_peer_end(peer)
        except Exception as error:
            self.fail(f"watch over {peer}", error)

    def _on_peer_change(
        self, on_change: Callable[[str, bool], None] | None, peer: str, is_alive: bool
    ) -> None:
        if on_change:
            try:
                on_change(peer, is_alive)
            except Exception as error:  # also in the thread that watches, which must go on
                self.fail(f"watch over {peer}", error)
        if is_alive:
            self.health.faults.pop(peer, None)
        else:
            self.health.faults[peer] = f"node '{peer}' is silent: restart it (pack run, or pack up)"
            self._silences.note(peer, time.monotonic())
            self.report()
