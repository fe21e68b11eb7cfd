"""Finds a package's executables in the ament index, as `ros2 run` does."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError, get_package_prefix, get_packages_with_prefixes

from pack_core.errors import PackError


def packages_with_executables() -> list[str]:
    """Every package on this machine that has something to run, by name."""
    return [package for package in sorted(get_packages_with_prefixes()) if executables_of(package)]


def executables_of(package: str) -> list[Path]:
    """The files that `package` installs to be run, by name.

    Raises:
        PackError: there is no such package.
    """
    try:
        prefix = Path(get_package_prefix(package))
    except (PackageNotFoundError, ValueError) as error:
        raise PackError(
            f"package '{package}' not found; packages with executables: "
            f"{', '.join(packages_with_executables())} (looked in AMENT_PREFIX_PATH)"
        ) from error
    return sorted(_runnable_files(prefix / "lib" / package), key=lambda path: path.name)


def find_executable(package: str, executable: str) -> Path:
    """The file behind `ros2 run package executable`.

    Raises:
        PackError: there is no such package, or it has no such executable.
    """
    paths = executables_of(package)
    for path in paths:
        if path.name == executable:
            return path
    raise PackError(
        f"package '{package}' has no executable '{executable}'; it has: "
        f"{', '.join(path.name for path in paths) or 'none'}"
    )


def _runnable_files(folder: Path) -> Iterator[Path]:
    for path in folder.glob("**/*"):
        hidden = any(part.startswith(".") for part in path.relative_to(folder).parts[:-1])
        if path.is_file() and os.access(path, os.X_OK) and not hidden:
            yield path
