"""Everything but the ROS shells imports on a machine without rclpy."""

import subprocess
import sys
from pathlib import Path

import pytest

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"

IMPORT_WITHOUT_RCLPY = """
import sys
sys.modules["rclpy"] = None
import importlib
for name in sys.argv[1:]:
    importlib.import_module(name)
"""


def is_ros_shell(path: Path) -> bool:
    return path.name.endswith("_node.py") or "ros" in path.parent.parts


def core_modules(package: Path) -> list[str]:
    files = [path.relative_to(package) for path in sorted((package / package.name).rglob("*.py"))]
    cores = [path for path in files if not is_ros_shell(path)]
    return [".".join(path.with_suffix("").parts).removesuffix(".__init__") for path in cores]


def import_without_rclpy(*modules: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", IMPORT_WITHOUT_RCLPY, *modules]
    return subprocess.run(command, capture_output=True, text=True)


PACKAGES = sorted(path.parent for path in SOURCES.glob("*/setup.py"))


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_cores_import_with_rclpy_hidden(package: Path) -> None:
    modules = core_modules(package)
    assert package.name in modules
    outcome = import_without_rclpy(*modules)
    assert outcome.returncode == 0, outcome.stderr


def test_hiding_rclpy_is_noticed_by_a_module_that_needs_it() -> None:
    outcome = import_without_rclpy("pack_core.ros.contracts.packing")
    assert outcome.returncode != 0
    assert "rclpy" in outcome.stderr


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_every_folder_with_modules_is_a_package(package: Path) -> None:
    folders = {path.parent for path in (package / package.name).rglob("*.py")}
    assert [str(folder) for folder in folders if not (folder / "__init__.py").is_file()] == []
