"""A node's process: what it says when it ends, and when a library crashes in it."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pack_core.used_files import VARIABLE, told

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


USING = """
from pack_core.ros.run import run_node
from rclpy.node import Node

class Using(Node):
    def __init__(self):
        super().__init__("using")
        self.create_timer(0.01, self.work)

    def work(self):
        import pack_core.bag_topic  # once it runs
        print("works", flush=True)

raise SystemExit(run_node(Using))
"""
NODE, LATER = (f"ros_ws/src/pack_core/pack_core/{name}.py" for name in ("ros/run", "bag_topic"))


@pytest.mark.parametrize(
    ("number", "code", "used"),
    [(signal.SIGINT, 0, {NODE, LATER}), (signal.SIGTERM, 0, {NODE, LATER}), (signal.SIGKILL, -9, {NODE})],
)
def test_a_node_tells_what_it_used_however_it_ends(
    number: signal.Signals, code: int, used: set[str], tmp_path: Path
) -> None:
    """One that is killed has told what it used to begin with."""
    command, environment = [sys.executable, "-c", USING], {**os.environ, VARIABLE: str(tmp_path)}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "works\n"
        process.send_signal(number)
        process.communicate()
    assert process.returncode == code
    assert {NODE, LATER} & told(tmp_path) == used


MISLED = """
import sys
from pack_core.ros.run import run_node
from rclpy.node import Node

sys.exit(run_node(lambda: Node("misled"), ["misled", "--ros-args", "--params-file", "nothere.yaml"]))
"""


def test_ros_arguments_that_cannot_be_used_are_an_error() -> None:
    process = ended(MISLED)
    assert process.returncode == 2
    assert "error: ROS arguments that cannot be used: " in process.stderr
    assert "nothere.yaml" in process.stderr
