"""Pictures made in a thread of their own, so that drawing never holds up the physics."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable

from pack_core.cells.palletizing import PalletizingCell
from pack_core.errors import PackError
from pack_core.scene.palletizing.view import Picture
from pack_sim.palletizing.overhead_camera import OverheadCamera, OverheadCameraConfig
from pack_sim.palletizing.snapshot import Snapshot

NICENESS = 10
"""Of the thread that draws: the physics goes first."""


class CameraThread:
    """Takes one picture at a time.

    Args:
        cell: where the camera is.
        config: size of the pictures.
        on_picture: takes the time of exposure [s] and the picture, in that thread.
        on_error: takes what went wrong, in that thread; no more pictures come then.
    """

    def __init__(
        self,
        cell: PalletizingCell,
        config: OverheadCameraConfig,
        on_picture: Callable[[float, Picture], None],
        on_error: Callable[[str], None],
    ) -> None:
        self._cell, self._config = cell, config
        self._on_picture, self._on_error = on_picture, on_error
        self._wake = threading.Condition()
        self._snapshot: Snapshot | None = None
        self._is_ended = False
        self._thread = threading.Thread(target=self._run, name="camera")
        self._thread.start()

    def expose(self, snapshot: Snapshot) -> bool:
        """Have a picture taken; False while the last one is still being made, or when none can be."""
        with self._wake:
            if self._snapshot is not None or self._is_ended:
                return False
            self._snapshot = snapshot
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
            with OverheadCamera(self._cell, self._config) as camera:
                while snapshot := self._next():
                    self._on_picture(snapshot.time, camera.picture(snapshot))
                    with self._wake:
                        self._snapshot = None
        except PackError as error:
            self._end()
            self._on_error(str(error))

    def _next(self) -> Snapshot | None:
        """The next picture to take; None at the end."""
        with self._wake:
            self._wake.wait_for(lambda: self._snapshot is not None or self._is_ended)
            return None if self._is_ended else self._snapshot
