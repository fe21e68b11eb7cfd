"""Plans targets in a thread of its own, while the arm stands and its setpoints go on."""

from __future__ import annotations

import threading
from collections.abc import Callable

from pack_core.motion.target import MotionTarget
from pack_motion.target_planner import PreparedTarget


class PlanningThread:
    """Hands each target to `prepare`, one at a time; the newest replaces one that still waits.

    Args:
        prepare: plans a target.
        on_error: is told what should not have happened.
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
        """Plan this next; what was planned before is not wanted any more."""
        with self._condition:
            self._target, self._prepared = target, None
            self._condition.notify()

    def result(self) -> PreparedTarget | None:
        """What has been planned since the last call."""
        with self._condition:
            prepared, self._prepared = self._prepared, None
            return prepared

    def end(self) -> None:
        """Finish what is being planned, and end."""
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
                if self._target is None:
                    self._prepared = prepared
