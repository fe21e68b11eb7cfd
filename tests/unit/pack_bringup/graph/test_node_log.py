import io
from pathlib import Path

from pack_bringup.graph.bring_up import Tee, last_words, lines_of

LOG = """10:00:00 sim      | starting
10:00:01 mpc      | error: not mine
10:00:01 sim      | error: parameters of node 'sim': key 'seed' is 'abc'; allowed: a whole number
10:00:02 sim      | ended with exit code 2
10:00:02 recorder | Traceback
10:00:02 recorder | OSError: the disk is full
10:00:03 vision   | free(): invalid pointer
10:00:03 vision   | Fatal Python error: Aborted
10:00:03 vision   |
10:00:03 vision   | Thread 0x0001 (most recent call first):
10:00:03 vision   |   File "waiting.py", line 5 in wait
10:00:03 vision   |
10:00:03 vision   | Current thread 0x0002 (most recent call first):
10:00:03 vision   |   File "drawing.py", line 7 in draw
"""


def log_in(folder: Path) -> Path:
    path = folder / "nodes.log"
    path.write_text(LOG)
    return path


def test_the_error_that_a_node_named_is_its_last_word(tmp_path: Path) -> None:
    log = log_in(tmp_path)
    expected = "parameters of node 'sim': key 'seed' is 'abc'; allowed: a whole number"
    assert last_words(log, "sim") == f"{expected} (log: {log})"


def test_a_node_that_named_no_error_is_quoted(tmp_path: Path) -> None:
    said = last_words(log_in(tmp_path), "recorder")
    assert said.endswith("Traceback\n  OSError: the disk is full")
    assert str(tmp_path) in said


def test_of_a_node_that_crashed_the_thread_that_did_is_quoted(tmp_path: Path) -> None:
    said = last_words(log_in(tmp_path), "vision").splitlines()
    assert said[0].startswith("it crashed")
    assert [line.strip() for line in said[1:]] == [
        "free(): invalid pointer", "Fatal Python error: Aborted", 'File "drawing.py", line 7 in draw',
    ]  # fmt: skip


def test_a_node_that_wrote_nothing_is_said_to_have(tmp_path: Path) -> None:
    assert last_words(log_in(tmp_path), "planner").endswith("it wrote nothing")


def test_lines_are_told_apart_by_the_name_in_front(tmp_path: Path) -> None:
    assert lines_of(log_in(tmp_path), "mpc") == ["error: not mine"]


def test_a_file_gets_what_a_terminal_gets_without_its_colours() -> None:
    terminal, file = io.StringIO(), io.StringIO()
    Tee(terminal, file).write("\x1b[36m10:00 sim | \x1b[0mhello\n")
    assert terminal.getvalue().startswith("\x1b[36m")
    assert file.getvalue() == "10:00 sim | hello\n"
