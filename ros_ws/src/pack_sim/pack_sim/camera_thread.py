"""Pictures made in a thread of their own, so that drawing never holds up the physics."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from pack_core.errors import PackError

NICENESS = 10
"""Of the thread that draws: the physics goes first."""
Picture = npt.NDArray[np.uint8]
Snapshot = TypeVar("Snapshot", contravariant=True)


class Camera(Protocol[Snapshot]):
    """Draws snapshots."""

    def picture(self, snapshot: Snapshot, /) -> Picture:
        """The cell when the snapshot was taken, `(height, width, 3)` RGB."""
        ...


class CameraThread(Generic[Snapshot]):
    """Takes one picture at a time.

    Args:
        camera: is entered and used in that thread alone.
        on_picture: takes the time of exposure [s] and the picture, in that thread.
        on_error: takes what went wrong, in that thread; no more pictures come then.
    """

    def __init__(
        self,
        camera: AbstractContextManager[Camera[Snapshot]],
        on_picture: Callable[[float, Picture], None],
        on_error: Callable[[str], None],
    ) -> None:
        self._camera, self._on_picture, self._on_error = camera, on_picture, on_error
        self._wake = threading.Condition()
        self._exposed: tuple[float, Snapshot] | None = None
        self._is_ended = False
        self._thread = threading.Thread(target=self._run, name="camera")
        self._thread.start()

    def expose(self, time: float, snapshot: Snapshot) -> bool:
        """Have a picture taken; False while the last one is still being made, or when none can be."""
        with self._wake:
            if self._exposed is not None or self._is_ended:
                return False
            self._exposed = (time, snapshot)
            self._wake.notify()
        return True

    def close(self) -> None:
        """Take no more pictures."""
        self._end()
        self._thread.join()

    def _end(self) -> None:
        with self._wake:
            self._is_ended = True
            self._wake.notify()

    def _run(self) -> None:
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICENESS)
        try:
            with self._camera as camera:
                while (exposed := self._next()) is not None:
                    self._on_picture(exposed[0], camera.picture(exposed[1]))
                    with self._wake:
                        self._exposed = None
        except PackError as error:
            self._end()
            self._on_error(str(error))

    def _next(self) -> tuple[float, Snapshot] | None:
        """The next picture to take; None at the end."""
        with self._wake:
            self._wake.wait_for(lambda: self._exposed is not None or self._is_ended)
            return None if self._is_ended else self._exposed
