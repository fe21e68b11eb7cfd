"""tools/ros2, which set-up links into .venv/bin where there is no ros2 command."""

import os
import subprocess
from pathlib import Path

import pytest

from pack_core.paths import project_root

STAND_IN = project_root() / "tools" / "ros2"


def ros2(*arguments: str, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    search = f"{path}{os.pathsep}/usr/bin{os.pathsep}/bin" if path else "/usr/bin:/bin"
    return subprocess.run(
        [str(STAND_IN), *arguments], capture_output=True, text=True, env={**os.environ, "PATH": search}
    )


def test_run_starts_an_executable_of_the_ament_index(prefix: Path) -> None:
    assert ros2("run", "fruit", "peel", "--thin").stdout == "[--thin]\n"


def test_pkg_executables_lists_them(prefix: Path) -> None:
    assert ros2("pkg", "executables", "fruit").stdout == "fruit peel\n"


@pytest.mark.parametrize("arguments", [("topic", "list"), ("launch", "pack_bringup"), ("pkg", "list")])
def test_what_it_cannot_do_is_said_with_exit_code_2(arguments: tuple[str, ...]) -> None:
    outcome = ros2(*arguments)
    assert outcome.returncode == 2
    assert "stand-in" in outcome.stderr


def test_a_real_ros2_on_the_path_goes_first(tmp_path: Path) -> None:
    real = tmp_path / "ros2"
    real.write_text('#!/bin/sh\necho "real $*"; cat\n')
    real.chmod(0o755)
    assert ros2("topic", "list", path=tmp_path).stdout == "real topic list\n"
