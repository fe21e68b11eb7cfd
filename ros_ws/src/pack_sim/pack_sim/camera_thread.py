"""Pictures made in threads of their own, so that neither drawing nor ray casting holds up the physics."""

from __future__ import annotations

import ctypes
import os
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager
from queue import Queue
from typing import Generic, Protocol, TypeVar

from pack_core.errors import PackError

NICENESS = 10
"""Unix niceness of a thread that draws, so that the physics gets the processor first."""
PATIENCE = 10.0
"""Longest wait for a picture [s of wall clock]."""
Snapshot = TypeVar("Snapshot", contravariant=True)
Picture = TypeVar("Picture", covariant=True)


class SnapshotCamera(Protocol[Snapshot, Picture]):
    """Draws snapshots."""

    def picture(self, snapshot: Snapshot, /) -> Picture:
        """The cell when the snapshot was taken."""
        ...


class CameraThread(Generic[Snapshot, Picture]):
    """Takes one picture at a time; once made, it is ready to.

    A second thread of normal priority passes the pictures on. Copying megabytes holds the interpreter's
    lock, so that a thread of low priority that did it would make all others wait.

    Args:
        camera: the camera, which is entered and used only in the thread that draws.
        on_picture: called in the second thread with the time of exposure [s] and the picture.
        on_error: called in the thread that draws with what went wrong; no more pictures come then.
        niceness: Unix niceness of the thread that draws.
    """

    def __init__(
        self,
        camera: AbstractContextManager[SnapshotCamera[Snapshot, Picture]],
        on_picture: Callable[[float, Picture], None],
        on_error: Callable[[str], None],
        niceness: int = NICENESS,
    ) -> None:
        self._niceness = niceness
        self._camera, self._on_picture, self._on_error = camera, on_picture, on_error
        self._wake = threading.Condition()
        self._exposed: tuple[float, Snapshot] | None = None
        self._is_busy = self._is_ended = False
        self._is_open = threading.Event()
        self._drawn: Queue[tuple[float, Picture] | None] = Queue()
        # Daemons: of a node that is told to end while it is being built, nobody closes the camera.
        self._threads = (
            threading.Thread(target=self._draw, name="camera", daemon=True),
            threading.Thread(target=self._hand_out, name="pictures", daemon=True),
        )
        for thread in self._threads:
            thread.start()
        # Making the graphics context holds the interpreter's lock for a second, on a busy machine for many.
        # A node that does it before it says that it is alive is not taken for a silent one.
        self._is_open.wait()

    def expose(self, time: float, snapshot: Snapshot) -> bool:
        """Start to draw a picture; False while the last one is still being drawn, or after an error."""
        with self._wake:
            if self._is_busy or self._is_ended:
                return False
            self._exposed, self._is_busy = (time, snapshot), True
            self._wake.notify_all()
        return True

    def wait(self) -> None:
        """Wait until the last picture has been handed out, but no longer than `PATIENCE`."""
        with self._wake:
            self._wake.wait_for(lambda: not self._is_busy or self._is_ended, PATIENCE)

    def close(self) -> None:
        """Take no more pictures, wait for both threads to end, and give their memory back."""
        self._end()
        for thread in self._threads:
            thread.join()
        # glibc keeps what the threads of a graphics context have freed, about 15 MB of each context in pieces
        # that the next one does not fill: a cell that is reset for hours would grow.
        ctypes.CDLL("libc.so.6").malloc_trim(0)

    def _end(self) -> None:
        with self._wake:
            self._is_ended = True
            self._wake.notify_all()

    def _draw(self) -> None:
        try:
            with self._camera as camera:
                self._is_open.set()
                # Only now: at low priority making the context would keep all other threads waiting.
                os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), self._niceness)
                while (exposed := self._next()) is not None:
                    self._drawn.put((exposed[0], camera.picture(exposed[1])))
        except PackError as error:
            self._end()
            self._on_error(str(error))
        except Exception as error:  # of the graphics library, which has errors of many kinds
            self._end()
            self._on_error(f"no more pictures can be drawn: {error!r}")
        finally:
            self._is_open.set()
            self._drawn.put(None)

    def _hand_out(self) -> None:
        while (drawn := self._drawn.get()) is not None:
            try:
                self._on_picture(*drawn)
            except Exception as error:  # whoever takes pictures must not keep the next one from being taken
                self._on_error(f"a picture could not be handed out: {error!r}")
            del drawn  # a picture has 25 MB; it would be kept until the next one
            with self._wake:
                self._is_busy = False
                self._wake.notify_all()

    def _next(self) -> tuple[float, Snapshot] | None:
        """Wait for the next snapshot to draw; None at the end."""
        with self._wake:
            self._wake.wait_for(lambda: self._exposed is not None or self._is_ended)
            exposed, self._exposed = self._exposed, None
            return None if self._is_ended else exposed
