"""A process that is told to end while it builds its node ends, though nobody closes its camera."""

import subprocess
import sys

UNCLOSED = """
from contextlib import nullcontext
from pack_sim.camera_thread import CameraThread

CameraThread(nullcontext(), lambda time, picture: None, print)
"""


def test_a_camera_that_nobody_closes_does_not_keep_its_process_alive() -> None:
    ended = subprocess.run([sys.executable, "-c", UNCLOSED], timeout=60.0, check=False)
    assert ended.returncode == 0
