"""A camera in a thread of its own: it can be waited for, and keeps no process alive."""

import subprocess
import sys
import threading
from contextlib import AbstractContextManager, nullcontext

import pytest

from pack_sim.camera_thread import CameraThread, SnapshotCamera


class SlowCamera:
    """Draws when it is let."""

    def __init__(self) -> None:
        self.may_draw = threading.Event()

    def picture(self, snapshot: str) -> str:
        self.may_draw.wait()
        return snapshot


UNCLOSED = """
from contextlib import nullcontext
from pack_sim.camera_thread import CameraThread

CameraThread(nullcontext(), lambda time, picture: None, print)
"""


def test_a_camera_that_nobody_closes_does_not_keep_its_process_alive() -> None:
    ended = subprocess.run([sys.executable, "-c", UNCLOSED], timeout=60.0, check=False)
    assert ended.returncode == 0


def test_who_waits_goes_on_once_the_picture_was_handed_out() -> None:
    camera, taken = SlowCamera(), list[tuple[float, str]]()
    entered: AbstractContextManager[SnapshotCamera[str, str]] = nullcontext(camera)
    thread = CameraThread(entered, lambda *picture: taken.append(picture), pytest.fail)
    thread.wait()  # no picture was asked for
    assert thread.expose(1.5, "a box")
    threading.Timer(0.05, camera.may_draw.set).start()
    thread.wait()
    assert taken == [(1.5, "a box")]
    thread.close()
