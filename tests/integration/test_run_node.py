"""A node's process: what it says when it ends, and when a library crashes in it."""

import subprocess
import sys

CRASHING = """
import os
from pack_core.ros.run import run_node

def make_a_camera():
    os.abort()

run_node(make_a_camera)
"""

ENDING = """
import rclpy, ruckig
from pack_core.ros.run import run_node
from rclpy.node import Node

class Ending(Node):
    def __init__(self):
        super().__init__("ending")
        self.way, self.itself = ruckig.Trajectory(6), self  # only garbage collection frees a cycle
        self.create_timer(0.01, rclpy.shutdown)

run_node(Ending)
"""


def ended(script: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)


def test_of_a_crash_in_c_code_the_log_says_what_the_thread_was_doing() -> None:
    process = ended(CRASHING)
    assert process.returncode == -6
    assert "Fatal Python error: Aborted" in process.stderr
    assert "in make_a_camera" in process.stderr


def test_a_node_ends_without_a_word_of_objects_that_nobody_freed() -> None:
    process = ended(ENDING)
    assert (process.returncode, process.stdout, process.stderr) == (0, "", "")
