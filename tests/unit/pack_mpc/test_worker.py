"""The asynchronous worker."""

import threading
from collections.abc import Callable, Iterator

import pytest
import yaml

from pack_core.paths import config_path
from pack_mpc.worker import Worker, WorkerConfig


class Recorder:
    """A step that notes its latencies and errors, and can be waited for."""

    def __init__(self, outcomes: list[float | Exception | None], waiting_period: float = 0.0) -> None:
        self.latencies: list[float] = []
        self.errors: list[Exception] = []
        self.done = threading.Event()
        self._outcomes = iter(outcomes)
        config = WorkerConfig(latency=0.05, latency_gain=0.5, waiting_period=waiting_period)
        self.worker = Worker(self.step, config, self.errors.append)

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


def test_a_worker_that_waits_for_a_placement_leaves_the_processor_to_the_planner() -> None:
    recorder = Recorder([0.03, None], waiting_period=1000.0)
    recorder.worker.is_waiting = True
    recorder.worker.wake()
    assert not recorder.done.wait(0.3), "the second iteration did not wait for its period"
    recorder.worker.stop()  # returns at once, though the period is not over
    assert len(recorder.latencies) == 1


def test_a_worker_that_waits_for_nothing_plans_as_fast_as_it_can() -> None:
    recorder = Recorder([0.03, 0.03, None], waiting_period=1000.0)
    recorder.worker.wake()
    assert recorder.done.wait(30.0)
    recorder.worker.stop()


def test_the_arm_does_not_brake_between_two_plans_while_a_placement_is_planned() -> None:
    def shipped(node: str) -> dict:
        text = config_path("nodes", "packing", f"{node}.yaml").read_text()
        return yaml.safe_load(text)[node]["ros__parameters"]

    # what is left is for an iteration that takes longer than the one before
    assert shipped("mpc")["worker"]["waiting_period"] <= 0.7 * shipped("sim")["watchdog"]
