"""A whole cell, its page and Foxglove's server: nothing of it can be reached from another machine."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec

import pytest

import network_rig
from network_rig import ADDRESSES, HERE, NOT_HEARD, THERE, on_machine, stranger, who_heard
from pack_core.cells import CELLS

pytestmark = [pytest.mark.e2e, pytest.mark.long, pytest.mark.alone, pytest.mark.timeout(400)]
LISTENS = "ss -Hltun"
"""Lists every UDP and TCP socket of a machine that listens, its address in the fifth column."""
PACK = "from pack_bringup.cli.main import main; main()"
KNOCK = "import socket, sys; socket.create_connection((sys.argv[1], int(sys.argv[2])), 2.0)"


@pytest.fixture(scope="module")
def two_machines() -> Iterator[None]:
    """For the tests of this file; skipped where there are no network namespaces."""
    with network_rig.two_machines():
        yield


def listening() -> set[tuple[str, int]]:
    """Address and port of all that listens on the machine of the cell."""
    command = ["ip", "netns", "exec", HERE, *LISTENS.split()]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    places = [line.split()[4].rpartition(":") for line in lines]
    return {(address, int(port)) for address, _, port in places}


@pytest.mark.usefixtures("two_machines")
@pytest.mark.parametrize("cell", CELLS)
def test_a_cell_with_its_pages_listens_on_loopback_and_is_not_heard_elsewhere(cell: str) -> None:
    with socket.socket() as probe:  # free here, and so on the other machine, which has nothing yet
        probe.bind(("127.0.0.1", 0))
        page = probe.getsockname()[1]
    up = [sys.executable, "-c", PACK, "up", cell, "--domain", "0"]
    up += ["--live", "--port", str(page)]
    served = {page}
    if find_spec("foxglove"):  # an extra
        up, served = [*up, "--foxglove"], {page, 8765}
    command, output = on_machine(HERE, *up), {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with subprocess.Popen(command, text=True, **output) as process:
        try:
            said = []
            for line in process.stdout or ():
                said.append(line)
                if "ready: " in line:
                    break
            assert "ready: " in said[-1], "".join(said)
            found = listening()
            assert {address for address, _ in found} == {"127.0.0.1"}
            assert served <= {port for _, port in found}
            assert who_heard(stranger()) == [NOT_HEARD]
            for port in served:
                knock = on_machine(THERE, sys.executable, "-c", KNOCK, ADDRESSES[HERE], str(port))
                refused = subprocess.run(knock, capture_output=True, text=True, check=False)
                assert "ConnectionRefusedError" in refused.stderr
        finally:
            process.terminate()
