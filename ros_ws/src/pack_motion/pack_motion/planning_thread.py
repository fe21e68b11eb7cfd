"""Plans targets in a separate thread, so that setpoints for the standing arm are not delayed."""

from __future__ import annotations

import threading
from collections.abc import Callable

from pack_core.motion.target import MotionTarget
from pack_motion.target_planner import PreparedTarget


class PlanningThread:
    """Passes each target to `prepare`, one at a time; the newest replaces one that is still waiting.

    Args:
        prepare: plans a target.
        on_error: called with an unexpected exception of `prepare`.
    """

    def __init__(
        self, prepare: Callable[[MotionTarget], PreparedTarget], on_error: Callable[[Exception], None]
    ) -> None:
        self._prepare, self._on_error = prepare, on_error
        self._condition = threading.Condition()
        self._target: MotionTarget | None = None
        self._prepared: PreparedTarget | None = None
        self._is_ended = False
        self._thread = threading.Thread(target=self._run, name="planning", daemon=True)
        self._thread.start()

    def submit(self, target: MotionTarget) -> None:
        """Plan this target next; the result of an earlier one is dropped."""
        with self._condition:
            self._target, self._prepared = target, None
            self._condition.notify()

    def result(self) -> PreparedTarget | None:
        """The target planned since the last call; None while there is none."""
        with self._condition:
            prepared, self._prepared = self._prepared, None
            return prepared

    def end(self) -> None:
        """Finish the target that is being planned, and end the thread."""
        with self._condition:
            self._is_ended = True
            self._condition.notify()
        self._thread.join()

    def _run(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._target is not None or self._is_ended)
                if self._is_ended:
                    return
                target, self._target = self._target, None
            assert target is not None
            try:
                prepared = self._prepare(target)
            except Exception as error:
                self._on_error(error)
                prepared = PreparedTarget(target, None, str(error))
            with self._condition:
                if self._target is None:  # otherwise a newer target waits and this result is dropped
                    self._prepared = prepared
