"""A command that is told to end by SIGTERM ends as by Ctrl-C."""

import signal
from collections.abc import Iterator

import pytest

from pack_bringup.cli.terminal import end_as_by_ctrl_c


@pytest.fixture(autouse=True)
def handlers() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def test_sigterm_interrupts() -> None:
    end_as_by_ctrl_c()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGTERM)


def test_an_ignored_ctrl_c_is_heeded_where_it_is_asked_for() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_as_by_ctrl_c(signal.SIGINT, signal.SIGTERM)
    for number in (signal.SIGINT, signal.SIGTERM):
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(number)
