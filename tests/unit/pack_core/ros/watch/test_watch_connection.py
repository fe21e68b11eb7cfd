"""Watch connections: a process's end is known at once, a living one is never taken for dead."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest

from pack_core.ros.watch import local_nodes
from pack_core.ros.watch.local_nodes import nodes_on_this_machine
from pack_core.ros.watch.watch_connection import WatchConnection
from pack_core.ros.watch.watch_socket import BACKLOG, MOST_WATCHERS, WatchSocket

DOMAIN = os.getpid()
CHILD = f"""
import sys
from pack_core.ros.watch.watch_socket import WatchSocket
watched = WatchSocket({DOMAIN}, "child")
print("up", flush=True)
sys.stdin.read()
"""
FORKS = f"""
import os, sys, signal
from pack_core.ros.watch.watch_socket import WatchSocket
watched = WatchSocket({DOMAIN}, "child")
print("up", flush=True)
sys.stdin.readline()
copy = os.fork()
if copy:
    print(copy, flush=True)
signal.pause()
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


def test_the_kill_is_known_before_the_system_has_closed_the_sockets_of_the_process() -> None:
    """A copy of the process keeps them open, as the clearing of a large memory does for a while."""
    child = subprocess.Popen(
        [sys.executable, "-c", FORKS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdin is not None
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    connection = WatchConnection(DOMAIN, "child")
    assert connection.wait_for_answer()
    child.stdin.write("fork\n")
    child.stdin.flush()
    copy = int(child.stdout.readline())
    ended = end_of(connection)
    child.kill()
    assert ended.wait(2.0)
    assert "child" in nodes_on_this_machine()[DOMAIN]
    again = WatchConnection(DOMAIN, "child")
    assert again.is_open
    threading.Timer(0.1, os.kill, (copy, signal.SIGKILL)).start()
    assert not again.wait_for_answer()
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


def test_a_node_that_one_reading_of_the_list_leaves_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = [f"0000: 00000002 00000000 00010000 0001 01 1 @packcell/7/{name}" for name in ("mpc", "sim")]
    readings = iter(["", listed[0], listed[1]])
    monkeypatch.setattr(local_nodes, "SOCKETS", SimpleNamespace(read_text=lambda: next(readings)))
    assert nodes_on_this_machine() == {7: {"mpc", "sim"}}


def test_watchers_that_came_and_went_leave_room_for_the_next() -> None:
    watched = WatchSocket(DOMAIN, "popular")
    for _ in range(2 * MOST_WATCHERS):
        WatchConnection(DOMAIN, "popular").close()
    deadline = time.monotonic() + 5.0
    connection = WatchConnection(DOMAIN, "popular")
    while not connection.is_open and time.monotonic() < deadline:
        connection = WatchConnection(DOMAIN, "popular")
    assert connection.is_open
    ended = end_of(connection)
    watched.close()
    assert ended.wait(2.0)


def test_too_many_watchers_hold_up_nobody_and_take_the_node_for_no_dead_one() -> None:
    watched = WatchSocket(DOMAIN, "crowded")
    begin = time.monotonic()
    crowd = [WatchConnection(DOMAIN, "crowded") for _ in range(MOST_WATCHERS + BACKLOG + 20)]
    assert time.monotonic() - begin < 10.0
    connected = [connection for connection in crowd if connection.is_open]
    assert len(connected) >= BACKLOG
    ends = [end_of(connection) for connection in connected]
    assert not any(end.is_set() for end in ends)
    watched.close()
    assert all(end.wait(2.0) for end in ends)


def test_a_frozen_process_holds_up_no_watcher() -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    child.send_signal(signal.SIGSTOP)
    os.waitpid(child.pid, os.WUNTRACED)  # until it stands, it would let watchers in
    begin = time.monotonic()
    crowd = [WatchConnection(DOMAIN, "child") for _ in range(BACKLOG + 20)]
    assert time.monotonic() - begin < 10.0
    assert crowd[0].is_open
    assert not crowd[-1].is_open
    child.kill()
    child.wait()


def test_a_process_of_another_user_is_neither_watched_nor_let_in(monkeypatch: pytest.MonkeyPatch) -> None:
    watched = WatchSocket(DOMAIN, "guarded")
    monkeypatch.setattr(local_nodes.os, "geteuid", lambda: os.getuid() + 1)
    monkeypatch.setattr(local_nodes, "ROOT", os.getuid() + 2)
    assert not WatchConnection(DOMAIN, "guarded").is_open
    watched.close()
