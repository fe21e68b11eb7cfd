"""Lifelines: their end is known at once, a living process is never taken for dead."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import pytest

from pack_core.ros.lifeline import Grasp, Lifeline

DOMAIN = os.getpid()
CHILD = f"""
import sys
from pack_core.ros.lifeline import Lifeline
line = Lifeline({DOMAIN}, "child")
print("up", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def cut() -> threading.Event:
    return threading.Event()


def test_the_kill_of_a_process_is_known_at_once(cut: threading.Event) -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    Grasp(DOMAIN, "child", cut.set)
    assert not cut.wait(0.1)
    child.kill()
    assert cut.wait(2.0)
    child.wait()


def test_a_node_that_ends_in_order_cuts_its_lifeline(cut: threading.Event) -> None:
    line = Lifeline(DOMAIN, "node")
    Grasp(DOMAIN, "node", cut.set)
    line.cut()
    assert cut.wait(2.0)


def test_whoever_let_go_hears_nothing(cut: threading.Event) -> None:
    line = Lifeline(DOMAIN, "node")
    grasp = Grasp(DOMAIN, "node", cut.set)
    grasp.release()
    line.cut()
    assert not cut.wait(0.1)


def test_a_node_of_another_domain_or_machine_is_not_taken_for_dead(cut: threading.Event) -> None:
    line = Lifeline(DOMAIN, "node")
    Grasp(DOMAIN + 1, "node", cut.set)
    Grasp(DOMAIN, "stranger", cut.set)
    assert not cut.wait(0.1)
    line.cut()


def test_a_second_node_of_the_same_name_is_no_error(cut: threading.Event) -> None:
    first, second = Lifeline(DOMAIN, "node"), Lifeline(DOMAIN, "node")
    Grasp(DOMAIN, "node", cut.set)
    second.cut()
    assert not cut.wait(0.1)
    first.cut()
    assert cut.wait(2.0)
