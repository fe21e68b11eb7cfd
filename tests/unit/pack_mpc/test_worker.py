"""The asynchronous worker."""

import threading
from collections.abc import Callable, Iterator

import pytest

from pack_mpc.worker import Worker, WorkerConfig


class Recorder:
    """A step that notes its latencies and errors, and can be waited for."""

    def __init__(self, outcomes: list[float | Exception | None]) -> None:
        self.latencies: list[float] = []
        self.errors: list[Exception] = []
        self.done = threading.Event()
        self._outcomes = iter(outcomes)
        self.worker = Worker(self.step, WorkerConfig(latency=0.05, latency_gain=0.5), self.errors.append)

    def step(self, latency: float) -> float | None:
        self.latencies.append(latency)
        outcome = next(self._outcomes, None)
        if outcome is None:
            self.done.set()
            return None
        self.worker.wake()
        if isinstance(outcome, Exception):
            raise outcome
        return outcome


@pytest.fixture
def run() -> Iterator[Callable[[list[float | Exception | None]], Recorder]]:
    recorders = []

    def start(outcomes: list[float | Exception | None]) -> Recorder:
        recorder = Recorder(outcomes)
        recorders.append(recorder)
        recorder.worker.wake()
        assert recorder.done.wait(30.0)
        return recorder

    yield start
    for recorder in recorders:
        recorder.worker.stop()


def test_latency_follows_what_was_observed(run) -> None:
    recorder = run([0.03, 0.03, None])
    assert recorder.latencies == pytest.approx([0.05, 0.04, 0.035])


def test_latency_is_bounded(run) -> None:
    recorder = run([9.0, None])
    assert recorder.latencies[-1] == WorkerConfig().latency_max


def test_an_error_is_told_and_the_worker_goes_on(run) -> None:
    recorder = run([0.03, ValueError("broken"), 0.03, None])
    assert [str(error) for error in recorder.errors] == ["broken"]
    assert len(recorder.latencies) == 4


def test_a_worker_that_is_not_woken_does_nothing() -> None:
    recorder = Recorder([0.03])
    recorder.worker.stop()
    assert recorder.latencies == []
