"""`pack --help` must not load what only a command's work needs."""

import subprocess
import sys

import pytest

HEAVY = ("cv2", "matplotlib", "mujoco", "numba", "rclpy", "scipy", "shapely")


@pytest.mark.parametrize("module", HEAVY)
def test_the_command_line_loads_its_workhorses_late(module: str, loaded: set[str]) -> None:
    assert module not in loaded


@pytest.fixture(scope="module")
def loaded() -> set[str]:
    code = "import sys, pack_bringup.cli.main; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())
