"""From `main()` to a clean end: Ctrl-C, SIGTERM, a bad configuration."""

from __future__ import annotations

import faulthandler
import gc
import os
import signal
import sys
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from pack_core.errors import PackError
from pack_core.network import check_bound, enforce, network_warning
from pack_core.ros.node import CellNode
from pack_core.used_files import tell_if_asked, watch_if_asked

SWITCH_INTERVAL = 0.001
"""A thread that has to react waits this long for one that computes [s]; Python's default is 0.005."""

STDERR = 2
"""File descriptor of what a process says of errors."""

ENDS = (ExternalShutdownException,)
"""What an executor raises because the process is told to stop."""


def run_node(make: Callable[[], Node], args: list[str] | None = None) -> int:
    """Spin the node that `make` builds until it is told to stop.

    Returns:
        0 after a clean end, 2 when the configuration was refused, or the network is wider than asked for.
    """
    sys.setswitchinterval(SWITCH_INTERVAL)
    # Where a library's C or C++ code breaks, the log then says what every thread was doing.
    faulthandler.enable(STDERR)
    # An interrupt shuts the context down, which ends spinning. Raised as an exception besides, at whatever
    # line it meets, it could leave a lock held, and the end would wait for it.
    signal.signal(signal.SIGINT, lambda *_: None)
    watch_if_asked()
    executor = node = None
    try:
        try:
            start_ros(args=args)
        except rclpy_implementation.RCLError as error:
            print(f"error: ROS arguments that cannot be used: {error}", file=sys.stderr)
            return 2
        executor = SingleThreadedExecutor()
        node = make()
        confirm_network()
        tell_if_asked()  # for a node that is killed
        # What the imports and the constructor made stays; looking through all of it again and again for
        # garbage would hold up every thread, for 50 ms and more at a time.
        gc.collect()
        gc.freeze()
        executor.add_node(node)
        _spin(executor, node)
    except PackError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except ExternalShutdownException:
        pass
    except Exception:
        if rclpy.ok():
            raise  # otherwise it met the end while it was being built or worked
    finally:
        if executor is not None:
            executor.shutdown()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
        tell_if_asked()
        gc.unfreeze()  # so that what the node was made of is freed: nanobind (ruckig) reports what is not
        # All is done. A second Ctrl-C would meet the interpreter at its end, which takes its handler away
        # first, and the exit code would tell of a failure.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    return 0


def start_ros(**options: Any) -> None:
    """`rclpy.init`, in an environment in which no variable opens the network or hinders discovery.

    Raises:
        ConfigError: a variable has a value with which nothing starts.
    """
    for sentence in enforce(os.environ):
        print(f"warning: {sentence}", file=sys.stderr)
    rclpy.init(**options)


def confirm_network() -> None:
    """Make sure that this process listens where it may and nowhere else; say so where that is open.

    To be called once the first node is made: the middleware opens its sockets with it.

    Raises:
        ConfigError: it listens elsewhere.
    """
    if opened := check_bound():
        print(network_warning(opened), file=sys.stderr)


def _spin(executor: SingleThreadedExecutor, node: Node) -> None:
    """Run callbacks until the process is told to stop; once the node is up, no error ends it."""
    while rclpy.ok():
        try:
            executor.spin_once()
        except Exception as error:
            # Before it is up, an error is about its configuration. Later ones come only from what has no
            # guard of its own, such as the answer to a service's client.
            if not isinstance(node, CellNode) or not node.is_up or isinstance(error, ENDS):
                raise
            node.fail("a callback", error)
