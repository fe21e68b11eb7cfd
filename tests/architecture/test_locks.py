"""What is installed is what was locked, byte for byte."""

import re

import pytest

from pack_core.paths import project_root

REQUIREMENT = re.compile(r"[\w.-]+(\[[\w,-]+\])?==\S+")


def requirements(name: str) -> list[str]:
    """Each requirement of a lock file in a line of its own."""
    lines = (project_root() / "requirements" / name).read_text().replace("\\\n", " ").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


@pytest.mark.parametrize("name", ["locked.txt", "cluster.txt", "mutation.txt", "opcua.txt"])
def test_every_locked_requirement_has_one_version_and_hashes(name: str) -> None:
    found = requirements(name)
    assert found
    for line in found:
        assert REQUIREMENT.match(line), line
        assert "--hash=sha256:" in line, line


def test_the_setup_refuses_what_has_no_hash() -> None:
    (installs,) = [
        line for line in (project_root() / "tools" / "setup.sh").read_text().splitlines() if "-r req" in line
    ]
    assert "--require-hashes" in installs
