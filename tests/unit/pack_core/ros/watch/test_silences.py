"""Silences are written to the log when they last, and as errors when their node has ended."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from pack_core.ros.watch.peer_watch import LASTING, SilenceLog, SilentPeers


@dataclass
class Watch:
    """What is known of a peer."""

    peer: str = "sim"
    is_alive: bool = False
    has_ended: bool = True


class Logger:
    def __init__(self) -> None:
        self.lines: list[str] = []

    def error(self, text: str) -> None:
        self.lines.append(f"ERROR {text}")

    def warning(self, text: str) -> None:
        self.lines.append(f"WARN {text}")


@pytest.fixture
def logger() -> Logger:
    return Logger()


def test_a_silence_is_written_once_when_it_has_lasted(logger: Logger) -> None:
    log, watch = SilenceLog(logger), Watch()
    log.note("sim", 10.0)
    log.write([watch], 10.0 + 0.9 * LASTING)
    assert logger.lines == []
    for _ in range(2):
        log.write([Watch("other"), watch], 10.0 + 1.1 * LASTING)
    assert logger.lines == ["ERROR node 'sim' has ended: restart it (pack run, or pack up)"]


def test_a_peer_that_is_soon_heard_again_is_not_written_about(logger: Logger) -> None:
    log = SilenceLog(logger)
    log.note("sim", 10.0)
    log.write([Watch(is_alive=True)], 10.0 + 2.0 * LASTING)
    log.write([Watch()], 10.0 + 3.0 * LASTING)
    assert logger.lines == []


def test_a_peer_whose_process_lives_is_no_error(logger: Logger) -> None:
    log = SilenceLog(logger)
    log.note("sim", 10.0)
    log.write([Watch(has_ended=False)], 10.0 + 2.0 * LASTING)
    assert logger.lines == ["WARN node 'sim' lives but is silent: it hangs, or this machine is too busy"]


def test_a_silence_lasts_from_its_beginning_until_the_node_is_heard_of_again() -> None:
    silent = SilentPeers()
    assert not silent
    silent.note("sim", False, 10.0)
    silent.note("sim", False, 11.5)
    silent.note("mpc", False, 11.0)
    assert str(silent) == "mpc, sim"
    assert silent.lasting(1.0, 11.0) == []
    assert silent.lasting(1.0, 11.9) == ["sim"]
    silent.note("sim", True, 12.0)
    assert silent.lasting(1.0, 20.0) == ["mpc"]
    silent.note("mpc", True, 20.0)
    assert not silent
