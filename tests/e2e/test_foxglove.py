"""Whole cells with `pack up CELL --foxglove`, looked at as Foxglove and Lichtblick do."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from e2e.command import pack
from integration.foxglove_client import FoxgloveClient
from integration.harness import own_domain
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core.cells import CELLS
from pack_core.ros.contracts.contract import Kind
from pack_core.ros.contracts.table import wiring_of

pytest.importorskip("foxglove", reason="an extra: see docs/operate/rviz_and_foxglove.md")
pytestmark = [pytest.mark.e2e, pytest.mark.long, pytest.mark.timeout(300)]
PORT = 8765
"""The one that the command prints."""
JOINT_STATES = "/joint_states"


@contextmanager
def served(cell: str) -> Iterator[FoxgloveClient]:
    """A cell that is up, and a client that wants its joint states."""
    command = ("up", cell, "--foxglove", "--record", "never", "--set", "sim.real_time_factor=0.25")
    process = pack(*command, "--domain", str(own_domain()))
    try:
        wait_for_line(process, "ready: ")
        client = FoxgloveClient(JOINT_STATES, PORT)
        yield client
        client.close()
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)


def wait_for_line(process: subprocess.Popen[str], text: str) -> None:
    """Read what a command prints until a line has a text in it."""
    assert process.stdout is not None
    said = []
    for line in process.stdout:
        said.append(line)
        if text in line:
            return
    raise AssertionError("".join(said))


@pytest.mark.parametrize("cell", CELLS)
def test_the_topics_of_a_running_cell_are_served_to_be_read_only(cell: str) -> None:
    with served(cell) as client:
        deadline = time.monotonic() + 30.0
        while len(client.payloads) < 20:
            assert time.monotonic() < deadline, f"{len(client.payloads)} joint states; {client.said}"
            client.wait(0.1)
        assert set(client.channels) == {c.name for c in wiring_of(cell) if c.kind is Kind.TOPIC}
        first, last = (
            message_types().deserialize_cdr(data, "sensor_msgs/msg/JointState")
            for data in (client.payloads[0], client.payloads[-1])
        )
        assert len(first.position) == len(first.name) >= 6
        assert (last.header.stamp.sec, last.header.stamp.nanosec) > (
            first.header.stamp.sec, first.header.stamp.nanosec,
        )  # fmt: skip
        assert client.info["capabilities"] == ["time"]  # nothing to publish, call or set with
        assert client.said <= {"serverInfo", "advertise", "status"}
