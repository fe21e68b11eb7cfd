from pathlib import Path

import pytest

from pack_bringup.graph.executables import executables_of, find_executable, packages_with_executables
from pack_core.errors import PackError


def test_an_executable_is_found_by_the_ament_index(prefix: Path) -> None:
    assert find_executable("fruit", "peel") == prefix / "lib" / "fruit" / "peel"


def test_files_that_cannot_be_run_are_no_executables(prefix: Path) -> None:
    assert [path.name for path in executables_of("fruit")] == ["peel"]


def test_an_unknown_executable_is_answered_with_the_known_ones(prefix: Path) -> None:
    with pytest.raises(PackError, match="'fruit' has no executable 'slice'; it has: peel"):
        find_executable("fruit", "slice")


def test_an_unknown_package_is_answered_with_those_that_have_executables(prefix: Path) -> None:
    with pytest.raises(PackError, match=r"'nut' not found; .*fruit.*pack_sim.*AMENT_PREFIX_PATH"):
        find_executable("nut", "crack")


def test_packages_without_executables_are_left_out(prefix: Path) -> None:
    packages = packages_with_executables()
    assert "fruit" in packages
    assert "pack_interfaces" not in packages
