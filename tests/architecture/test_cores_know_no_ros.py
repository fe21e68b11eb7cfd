"""Everything but the ROS shells imports on a machine without rclpy."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
PACKAGES = sorted(path.parent for path in SOURCES.glob("*/setup.py"))
NEEDS_RCLPY = "pack_core.ros.contracts.packing"

IMPORT_WITHOUT_RCLPY = """
import importlib, json, sys, traceback
sys.modules["rclpy"] = None
errors = {}
for name in json.load(sys.stdin):
    try:
        importlib.import_module(name)
    except Exception:
        errors[name] = traceback.format_exc()
json.dump(errors, sys.stdout)
"""


def is_ros_shell(path: Path) -> bool:
    return path.name.endswith("_node.py") or "ros" in path.parent.parts


def core_modules(package: Path) -> list[str]:
    files = [path.relative_to(package) for path in sorted((package / package.name).rglob("*.py"))]
    cores = [path for path in files if not is_ros_shell(path)]
    return [".".join(path.with_suffix("").parts).removesuffix(".__init__") for path in cores]


@pytest.fixture(scope="module")
def errors() -> dict[str, str]:
    """What went wrong, by module, when one Python process without rclpy imported them all."""
    modules = [NEEDS_RCLPY, *(name for package in PACKAGES for name in core_modules(package))]
    outcome = subprocess.run(
        [sys.executable, "-c", IMPORT_WITHOUT_RCLPY], input=json.dumps(modules), capture_output=True,
        text=True, check=True,
    )  # fmt: skip
    return dict(json.loads(outcome.stdout))


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_cores_import_with_rclpy_hidden(package: Path, errors: dict[str, str]) -> None:
    modules = core_modules(package)
    assert package.name in modules
    assert [errors[name] for name in modules if name in errors] == []


def test_hiding_rclpy_is_noticed_by_a_module_that_needs_it(errors: dict[str, str]) -> None:
    assert "rclpy" in errors[NEEDS_RCLPY]


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_every_folder_with_modules_is_a_package(package: Path) -> None:
    folders = {path.parent for path in (package / package.name).rglob("*.py")}
    assert [str(folder) for folder in folders if not (folder / "__init__.py").is_file()] == []
