"""A node's process: what it leaves behind when a library crashes in it."""

import subprocess
import sys

CRASHING = """
import os
from pack_core.ros.run import run_node

def make_a_camera():
    os.abort()

run_node(make_a_camera)
"""


def test_of_a_crash_in_c_code_the_log_says_what_the_thread_was_doing() -> None:
    ended = subprocess.run([sys.executable, "-c", CRASHING], capture_output=True, text=True)
    assert ended.returncode == -6
    assert "Fatal Python error: Aborted" in ended.stderr
    assert "in make_a_camera" in ended.stderr
