"""Signals wait until a block is left, and then do what they did before."""

import os
import signal
import threading
from collections.abc import Iterator

import pytest

from pack_bringup.ros.deferred_signals import deferred_signals


@pytest.fixture(autouse=True)
def _handlers() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def test_ctrl_c_interrupts_after_the_block_and_not_within() -> None:
    lines = []

    def work() -> None:
        with deferred_signals():
            os.kill(os.getpid(), signal.SIGINT)
            lines.append("within")
        lines.append("behind")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert lines == ["within"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_handler_hears_of_each_signal_afterwards() -> None:
    heard: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _: heard.append(number))
    with deferred_signals():
        for _ in range(2):
            os.kill(os.getpid(), signal.SIGTERM)
            assert heard == []
    assert heard == [signal.SIGTERM, signal.SIGTERM]


def test_another_thread_is_left_alone() -> None:
    before, within = signal.getsignal(signal.SIGINT), []

    def work() -> None:
        with deferred_signals():
            within.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert within == [before]
