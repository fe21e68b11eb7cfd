"""Watch connections: a process's end is known at once, a living one is never taken for dead."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import pytest

from pack_core.ros.watch_connection import WatchConnection, WatchSocket

DOMAIN = os.getpid()
CHILD = f"""
import sys
from pack_core.ros.watch_connection import WatchSocket
watched = WatchSocket({DOMAIN}, "child")
print("up", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def ended() -> threading.Event:
    return threading.Event()


def test_the_kill_of_a_process_is_known_at_once(ended: threading.Event) -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    WatchConnection(DOMAIN, "child", ended.set)
    assert not ended.wait(0.1)
    child.kill()
    assert ended.wait(2.0)
    child.wait()


def test_a_node_that_ends_in_order_tells_its_watchers(ended: threading.Event) -> None:
    watched = WatchSocket(DOMAIN, "node")
    WatchConnection(DOMAIN, "node", ended.set)
    watched.close()
    assert ended.wait(2.0)


def test_whoever_let_go_hears_nothing(ended: threading.Event) -> None:
    watched = WatchSocket(DOMAIN, "node")
    connection = WatchConnection(DOMAIN, "node", ended.set)
    connection.close()
    watched.close()
    assert not ended.wait(0.1)


def test_a_node_of_another_domain_or_machine_is_not_taken_for_dead(ended: threading.Event) -> None:
    watched = WatchSocket(DOMAIN, "node")
    WatchConnection(DOMAIN + 1, "node", ended.set)
    WatchConnection(DOMAIN, "stranger", ended.set)
    assert not ended.wait(0.1)
    watched.close()


def test_a_second_node_of_the_same_name_is_no_error(ended: threading.Event) -> None:
    first, second = WatchSocket(DOMAIN, "node"), WatchSocket(DOMAIN, "node")
    WatchConnection(DOMAIN, "node", ended.set)
    second.close()
    assert not ended.wait(0.1)
    first.close()
    assert ended.wait(2.0)
