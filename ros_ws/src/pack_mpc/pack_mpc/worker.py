"""The asynchronous worker: a thread that always plans from the newest measurements."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config

PAUSE = 0.01
"""After an iteration in which there was nothing to plan [s of wall clock], as while a peer is silent."""
Step = Callable[[float], float | None]
"""One iteration: takes the latency to plan for [s], and returns the latency that it had [s], or None if
there was nothing to plan."""


class WorkerConfig(Config):
    """Parameters of the worker."""

    latency: PositiveFloat = Field(default=0.048, description="first guess of the planning latency [s]")
    latency_gain: float = Field(default=0.1, gt=0, le=1, description="share of a new value in the estimate")
    latency_max: PositiveFloat = Field(
        default=0.12, description="longest time over which a state is predicted [s]"
    )
    waiting_period: NonNegativeFloat = Field(
        default=0.06,
        description="least time from one iteration to the next while a placement is being planned, which "
        "needs the processor more; less than the driver's watchdog, or the arm brakes [s of wall clock]",
    )


class Worker:
    """Calls `step` again and again in a thread of its own, with an estimate of its latency.

    Args:
        step: one iteration.
        config: how the latency is estimated, and how often an iteration may begin.
        on_error: called with what an iteration raised; the worker goes on.

    Attributes:
        latency: estimate of the time from a measurement until the plan from it is sent [s].
        is_waiting: whether what the plans lead to is itself still being planned; iterations are fewer then.
    """

    def __init__(self, step: Step, config: WorkerConfig, on_error: Callable[[Exception], None]) -> None:
        self._step, self._config, self._on_error = step, config, on_error
        self._wake, self._stopped = threading.Event(), threading.Event()
        self.latency = config.latency
        self.is_waiting = False
        self._thread = threading.Thread(target=self._run, name="mpc worker", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Start an iteration: there is something new to plan from."""
        self._wake.set()

    def stop(self) -> None:
        """End the thread after the iteration in flight."""
        self._stopped.set()
        self._wake.set()
        self._thread.join()

    def _run(self) -> None:
        while True:
            self._wake.wait()
            self._wake.clear()
            if self._stopped.is_set():
                return
            began = time.monotonic()
            try:
                observed = self._step(self.latency)
            except Exception as error:
                self._on_error(error)
                continue
            if observed is None:
                self._stopped.wait(PAUSE)
            else:
                g, bound = self._config.latency_gain, self._config.latency_max
                self.latency = min((1 - g) * self.latency + g * max(observed, 0.0), bound)
                self._rest(began)

    def _rest(self, began: float) -> None:
        """Leave the processor to the placement planner until the next iteration may begin."""
        if self.is_waiting:
            self._stopped.wait(max(0.0, began + self._config.waiting_period - time.monotonic()))
