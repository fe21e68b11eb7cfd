"""Watch connections: a process's end is known at once, a living one is never taken for dead."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

from pack_core.ros.watch_connection import WatchConnection, WatchSocket, nodes_on_this_machine

DOMAIN = os.getpid()
CHILD = f"""
import sys
from pack_core.ros.watch_connection import WatchSocket
watched = WatchSocket({DOMAIN}, "child")
print("up", flush=True)
sys.stdin.read()
"""


def end_of(connection: WatchConnection) -> threading.Event:
    """An event that is set once the watched node has ended."""
    ended = threading.Event()

    def wait() -> None:
        connection.wait_for_end()
        ended.set()

    threading.Thread(target=wait, daemon=True).start()
    return ended


def test_the_kill_of_a_process_is_known_at_once() -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    ended = end_of(WatchConnection(DOMAIN, "child"))
    assert not ended.wait(0.1)
    child.kill()
    assert ended.wait(2.0)
    child.wait()


def test_a_node_that_ends_in_order_tells_its_watchers() -> None:
    watched = WatchSocket(DOMAIN, "node")
    connection = WatchConnection(DOMAIN, "node")
    assert connection.is_open
    ended = end_of(connection)
    watched.close()
    assert ended.wait(2.0)
    assert not connection.is_open


def test_a_watcher_that_closes_its_connection_waits_no_longer() -> None:
    watched = WatchSocket(DOMAIN, "node")
    connection = WatchConnection(DOMAIN, "node")
    ended = end_of(connection)
    assert not ended.wait(0.1)
    connection.close()
    assert ended.wait(2.0)
    watched.close()


def test_there_is_no_connection_to_a_node_of_another_domain_or_machine() -> None:
    watched = WatchSocket(DOMAIN, "node")
    for connection in (WatchConnection(DOMAIN + 1, "node"), WatchConnection(DOMAIN, "stranger")):
        assert not connection.is_open
        connection.close()
    watched.close()


def test_a_second_node_of_the_same_name_is_no_error() -> None:
    first, second = WatchSocket(DOMAIN, "node"), WatchSocket(DOMAIN, "node")
    ended = end_of(WatchConnection(DOMAIN, "node"))
    second.close()
    assert not ended.wait(0.1)
    first.close()
    assert ended.wait(2.0)


def test_nodes_of_this_machine_are_found_while_they_live() -> None:
    watched = WatchSocket(DOMAIN, "found")
    connection = WatchConnection(DOMAIN, "found")
    assert "found" in nodes_on_this_machine()[DOMAIN]
    watched.close()
    connection.close()
    assert "found" not in nodes_on_this_machine().get(DOMAIN, set())
