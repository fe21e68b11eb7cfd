"""Keys for the nodes of a cell: the script asks for one a node, the launch file gives each its own."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.launch import enclave_arguments, security_environment
from pack_core.cells import CELLS
from pack_core.errors import ConfigError
from pack_core.paths import project_root

SCRIPT = project_root() / "tools" / "keystore.sh"
ROS2 = """#!/bin/sh
echo "$@" >> "$CALLS"
case "$2" in
  create_keystore) mkdir -p "$3/enclaves" ;;
  create_enclave) mkdir -p "$3/enclaves$4" ;;
esac
"""


def run_script(folder: Path, *arguments: str, with_ros2: bool = True) -> subprocess.CompletedProcess[str]:
    """Run the script with a stand-in for `ros2 security`, which the wheels do not have."""
    tools = folder / "tools"
    tools.mkdir(exist_ok=True)
    ros2 = tools / "ros2"
    ros2.write_text(ROS2 if with_ros2 else "#!/bin/sh\nexit 1\n")
    ros2.chmod(0o755)
    variables = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "CALLS": str(folder / "calls")}
    return subprocess.run(
        [SCRIPT, *arguments], env=variables, capture_output=True, text=True, check=False, timeout=20
    )


@pytest.mark.parametrize("cell", CELLS)
def test_every_node_of_a_cell_and_the_operator_get_a_key(tmp_path: Path, cell: str) -> None:
    keystore = str(tmp_path / "keys")
    assert run_script(tmp_path, cell, keystore).returncode == 0
    for node in (*(node.name for node in load_graph(cell).nodes), "operator"):
        assert enclave_arguments(keystore, cell, node) == ["--enclave", f"/packcell/{cell}/{node}"]
    assert security_environment(keystore)["ROS_SECURITY_STRATEGY"] == "Enforce"
    calls = (tmp_path / "calls").read_text().splitlines()
    assert sum("create_enclave" in call for call in calls) == len(load_graph(cell).nodes) + 1
    assert (tmp_path / "keys").stat().st_mode & 0o077 == 0, "others may read the keys"


def test_what_is_missing_is_named(tmp_path: Path) -> None:
    assert security_environment("") == {}
    assert enclave_arguments("", "packing", "sim") == []
    with pytest.raises(ConfigError, match=r"no keystore there; tools/keystore\.sh"):
        security_environment(str(tmp_path))
    with pytest.raises(ConfigError, match="no key /packcell/packing/sim"):
        enclave_arguments(str(tmp_path), "packing", "sim")
    assert "no cell 'oven'; allowed: blocks packing" in run_script(tmp_path, "oven", "keys").stderr
    assert "ros-jazzy-sros2" in run_script(tmp_path, "packing", "keys", with_ros2=False).stderr
