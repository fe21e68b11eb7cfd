"""Which code made a result: its version and commit, and the versions of the packages it depends on."""

from __future__ import annotations

import os
import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from pack_core.paths import project_root

PACKAGES = (
    "mujoco", "numpy", "scipy", "numba", "ruckig", "opencv-python-headless", "shapely", "rosbags",
    "ros-jazzy-rclpy", "ros-jazzy-rmw-fastrtps-cpp",
)  # fmt: skip


def project_version() -> str:
    """The version that stands in the file VERSION; every package.xml has the same."""
    return (project_root() / "VERSION").read_text().strip()


@cache
def installed_versions() -> dict[str, str]:
    """The version of PackCell and of every installed package that results depend on, by name."""
    versions = {"packcell": project_version()}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            continue
    return versions


def checked_out_commit() -> str:
    """The checked-out commit, `unknown` without git, marked `-dirty` when files differ from it.

    Published results do not count: nothing that is measured depends on them.
    """
    try:
        commit = _git("rev-parse", "HEAD")
        changes = _git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!results")
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return f"{commit}-dirty" if changes else commit


def _git(*arguments: str) -> str:
    command = ["git", "-C", str(project_root()), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10.0).stdout.strip()


def machine() -> str:
    """What kind of machine this is: processor, cores that may be used, and memory."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    model = models[0] if models else "unknown processor"
    return f"{model}, {len(os.sched_getaffinity(0))} cores, {memory:.0f} GiB"


def provenance(command: str) -> dict[str, Any]:
    """Origin of a result: command line, checked-out commit and versions of packages."""
    return {"command": command, "commit": checked_out_commit(), "versions": installed_versions()}
