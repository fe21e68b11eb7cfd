"""A node's niceness counts against the other nodes, each of which is a session of its own."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from pack_core.niceness import AUTOGROUP

SHARE = (
    "from pack_core.niceness import AUTOGROUP, share_niceness_with_session; "
    "share_niceness_with_session(); print(AUTOGROUP.read_text())"
)

pytestmark = pytest.mark.skipif(not AUTOGROUP.exists(), reason="this kernel has no autogroups")


@pytest.mark.parametrize("niceness", [0, 3])
def test_a_session_takes_the_niceness_of_the_process_that_began_it(niceness: int) -> None:
    assert group_of(niceness, start_new_session=True).endswith(f"nice {os.nice(0) + niceness}")


def test_a_process_within_a_session_leaves_it_alone() -> None:
    assert group_of(3, start_new_session=False) == AUTOGROUP.read_text().strip()


def group_of(niceness: int, *, start_new_session: bool) -> str:
    """What the kernel says of the autogroup of a process that shares its niceness."""
    command = ["nice", "-n", str(niceness), sys.executable, "-c", SHARE]
    return subprocess.run(
        command, start_new_session=start_new_session, capture_output=True, text=True, check=True
    ).stdout.strip()
