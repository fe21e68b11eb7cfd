"""Base of every node: endpoints from the wiring table, whose callbacks may raise without ending the node."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer

from pack_core.errors import PackError
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.failures import Failures
from pack_core.ros.health import Health
from pack_core.ros.parameter_node import ParameterNode


class GuardedNode(ParameterNode):
    """A node that goes on whatever its callbacks raise.

    A PackError means that a message was refused: it is dropped, counted and named. Any other error was not
    foreseen: it is counted and named, too, and `on_failure` is called, because what the callback worked on
    may be broken.

    Attributes:
        health: what was refused and what is wrong.
        failures: the errors that nobody foresaw.
    """

    def __init__(self, name: str, **kwargs: Any) -> None:
        # First, because rclpy's constructor creates services.
        self.health = Health(name)
        self.failures = Failures(self.health, self.get_logger)
        super().__init__(name, **kwargs)

    def on_failure(self, reason: str) -> None:
        """A callback failed in a way that nobody foresaw: a commanding node stops. The executor calls it."""

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

    def create_timer(self, period: float, callback: Callable[[], None], *args: Any, **kwargs: Any) -> Timer:
        """As of every node, but what the callback raises does not end it."""
        where = f"timer {getattr(callback, '__name__', callback)}"
        return super().create_timer(period, partial(self._call_guarded, where, callback), *args, **kwargs)

    def create_bare_timer(
        self, period: float, callback: Callable[[], None], *args: Any, **kwargs: Any
    ) -> Timer:
        """A timer whose callback ends the node where it raises, as one of rclpy does."""
        return super().create_timer(period, callback, *args, **kwargs)

    def create_service(self, srv_type: Any, name: str, serve: Callable[..., Any], **kwargs: Any) -> Service:
        """As of every node, but a request that fails is answered, with the reason, and does not end it."""
        return super().create_service(srv_type, name, partial(self._serve_guarded, name, serve), **kwargs)

    def _call_guarded(self, where: str, callback: Callable[[], None]) -> None:
        try:
            callback()
        except Exception as error:
            self.fail(where, error)
        else:
            self.failures.passed(where)

    def _serve_guarded(self, name: str, serve: Callable[[Any, Any], Any], request: Any, response: Any) -> Any:
        try:
            return serve(request, response)
        except Exception as error:
            self.fail(name, error)
            failed = type(response)()
            if hasattr(failed, "message"):
                failed.message = f"{name} failed: {error!r}; the node's log says more"
            return failed
