"""An answer that is waited for: asked for again, given up, and taken from whoever answers first."""

from __future__ import annotations

import pytest
from rclpy.task import Future

from pack_core.errors import PackError
from pack_core.ros.awaited_answer import AwaitedAnswer


class Server:
    """Notes what it is asked; a test answers."""

    def __init__(self) -> None:
        self.asked: list[Future] = []

    def ask(self) -> Future:
        self.asked.append(Future())
        return self.asked[-1]


def waiting(server: Server) -> AwaitedAnswer:
    return AwaitedAnswer(server.ask, "/plan", (5.0, 10.0), 100.0, None)


def test_an_answer_in_time_is_asked_for_once() -> None:
    server = Server()
    awaited = waiting(server)
    awaited.check(104.0)
    server.asked[0].set_result("a plan")
    awaited.check(200.0)
    assert awaited.future.result() == "a plan"
    assert len(server.asked) == 1


def test_a_lost_answer_is_asked_for_again_and_the_first_that_comes_counts() -> None:
    server = Server()
    awaited = waiting(server)
    awaited.check(105.0)
    server.asked[1].set_result("a plan")
    server.asked[0].set_result("a late plan")
    assert awaited.future.result() == "a plan"


def test_a_server_that_never_answers_is_given_up_with_its_name() -> None:
    server = Server()
    awaited = waiting(server)
    for now in (105.0, 114.0, 115.0):
        awaited.check(now)
    with pytest.raises(PackError, match="no answer from /plan in 15 s"):
        awaited.future.result()


def test_who_gives_up_first_is_believed() -> None:
    server = Server()
    awaited = waiting(server)
    awaited.give_up("canceled on request")
    server.asked[0].set_result("a plan")
    with pytest.raises(PackError, match="canceled on request"):
        awaited.future.result()
