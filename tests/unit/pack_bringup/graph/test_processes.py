import io
import os
import select
import signal
import subprocess
import sys
from pathlib import Path
from threading import Condition

import pytest

from pack_bringup.graph.processes import ProcessGroup
from pack_core.errors import PackError

SAYS_HELLO = [sys.executable, "-c", "print('hello')"]
FAILS = [sys.executable, "-c", "import sys; sys.exit(3)"]
WAITS = ["sleep", "60"]
IGNORES_CTRL_C = ["sh", "-c", "trap '' INT; echo ready; sleep 60"]
STARTS_ANOTHER = """
from pack_bringup.graph.processes import ProcessGroup
with ProcessGroup({"sim": ["sh", "-c", "echo $$; exec sleep 60"]}) as group:
    group.wait()
"""


class Mailbox(io.StringIO):
    """Log output that can be waited for."""

    def __init__(self) -> None:
        super().__init__()
        self._written = Condition()

    def write(self, text: str) -> int:
        with self._written:
            self._written.notify_all()
            return super().write(text)

    def wait_for(self, text: str, timeout: float = 10.0) -> bool:
        with self._written:
            return self._written.wait_for(lambda: text in self.getvalue(), timeout)


def test_log_lines_carry_the_name_of_their_process() -> None:
    output = io.StringIO()
    with ProcessGroup({"sim": SAYS_HELLO}, output=output) as group:
        assert group.wait(10)
    assert any(line.endswith("sim | hello") for line in output.getvalue().splitlines())


def test_a_death_is_named_and_leaves_the_others_running() -> None:
    output = io.StringIO()
    with ProcessGroup({"sim": FAILS, "mpc": WAITS}, output=output) as group:
        assert group.wait(10, count=1)
        assert group.exit_codes == {"sim": 3}
        assert group.running == ["mpc"]
    assert "ended with exit code 3" in output.getvalue()


def test_one_process_can_be_killed_alone() -> None:
    with ProcessGroup({"sim": WAITS, "mpc": WAITS}, output=io.StringIO()) as group:
        group.signal("mpc", signal.SIGKILL)
        assert group.wait(10, count=1)
        assert group.exit_codes == {"mpc": -signal.SIGKILL}
        assert group.running == ["sim"]


def test_leaving_the_group_ends_every_process() -> None:
    with ProcessGroup({"sim": WAITS, "mpc": WAITS}, output=io.StringIO()) as group:
        assert group.running == ["sim", "mpc"]
    assert group.exit_codes == {"sim": -signal.SIGINT, "mpc": -signal.SIGINT}


def test_ctrl_c_ends_them_at_once_although_we_ignore_it_as_a_background_job_does() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with ProcessGroup({"sim": WAITS, "mpc": WAITS}, output=io.StringIO()) as group:
            pass
    finally:
        signal.signal(signal.SIGINT, before)
    assert group.exit_codes == {"sim": -signal.SIGINT, "mpc": -signal.SIGINT}


def test_what_ignores_ctrl_c_is_killed_after_the_grace_time() -> None:
    output = Mailbox()
    group = ProcessGroup({"sim": IGNORES_CTRL_C}, output=output)
    group.start()
    assert output.wait_for("ready")
    group.stop(grace=0.5)
    assert group.wait(10)
    assert group.exit_codes == {"sim": -signal.SIGKILL}


def test_the_environment_is_added_to_ours() -> None:
    output = io.StringIO()
    with ProcessGroup(
        {"sim": ["sh", "-c", "echo $PACKCELL_FRUIT $HOME"]},
        environment={"PACKCELL_FRUIT": "pear"},
        output=output,
    ) as group:
        assert group.wait(10)
    assert f"pear {Path.home()}" in output.getvalue()


@pytest.mark.parametrize(
    ("name", "ours", "theirs"),
    [
        ("MALLOC_ARENA_MAX", None, "2"),
        ("MALLOC_ARENA_MAX", "7", "7"),
        ("MALLOC_MMAP_THRESHOLD_", None, "262144"),
        ("MALLOC_MMAP_THRESHOLD_", "65536", "65536"),
    ],
)
def test_the_c_library_keeps_little_free_memory_unless_we_say_otherwise(
    name: str, ours: str | None, theirs: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(name, raising=False)
    if ours is not None:
        monkeypatch.setenv(name, ours)
    log = Mailbox()
    with ProcessGroup({"sim": ["sh", "-c", f"echo it is ${name}"]}, output=log) as group:
        group.wait()
        assert log.wait_for(f"it is {theirs}")


def test_an_unknown_process_is_answered_with_the_known_ones() -> None:
    with (
        ProcessGroup({"sim": WAITS}, output=io.StringIO()) as group,
        pytest.raises(PackError, match="no process 'camera'; there are: sim"),
    ):
        group.signal("camera", signal.SIGINT)


def test_processes_end_when_their_starter_is_killed() -> None:
    starter = subprocess.Popen([sys.executable, "-c", STARTS_ANOTHER], stdout=subprocess.PIPE, text=True)
    assert starter.stdout is not None
    started = os.pidfd_open(int(starter.stdout.readline().split()[-1]))
    starter.kill()
    starter.communicate()
    assert select.select([started], [], [], 10)[0], "still alive"
