"""What the commands print is legible on 80 columns and without colours."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from pack_interfaces.action import PackObject, Palletize, Rearrange
from rich.cells import cell_len

from pack_bringup.blocks.goals import BlocksGoal
from pack_bringup.cli.evaluate import show
from pack_bringup.cli.terminal import show_table
from pack_bringup.cli.wiring import wiring
from pack_bringup.pace import Pace
from pack_bringup.packing.goals import PackingGoal
from pack_bringup.palletizing.goals import PalletizingGoal
from pack_core.cells import CELLS, cell_part
from pack_evaluation.evaluator import Evaluation
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import measure
from pack_evaluation.table import measure_rows
from pallet_fsm.states import State
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter

WIDTH = 80
COLOUR = "\x1b[3"
"""How a terminal is told a colour, from red to white."""
HEAD = ("", "success", "force stop", "detached", "timeout", "time [s]", "distance [cm]", "force [N]")
ROW = ("pack_it_in", "100/100", "0", "0", "0", "3.91 ± 1.72", "1.41 ± 0.61", "2.87 ± 0.93")
MAIN = "from pack_bringup.cli.main import main; main()"


@pytest.fixture(autouse=True)
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    monkeypatch.delenv("NO_COLOR", raising=False)


def legible(text: str) -> str:
    """The text, of which no line is longer than the terminal is wide, apart from paths that lead one."""
    lines = text.splitlines()
    assert lines
    assert all(cell_len(line) <= WIDTH for line in lines if not line.startswith(("report:", "video:")))
    return text


def test_a_table_that_fits_breaks_no_word_of_head_or_cells(capsys: pytest.CaptureFixture[str]) -> None:
    show_table(HEAD[:6], [ROW[:6]], title="Packing")
    text = legible(capsys.readouterr().out)
    for word in " ".join((*HEAD[:6], *ROW[:6])).split():
        assert word in text


def test_a_table_that_is_too_wide_becomes_a_list_with_every_cell_whole(
    capsys: pytest.CaptureFixture[str],
) -> None:
    show_table(HEAD, [ROW, ("another", *ROW[1:])], title="Packing", note="means of all")
    text = legible(capsys.readouterr().out)
    for cell in (*HEAD, *ROW, "another", "Packing", "means of all"):
        assert cell in text
    assert text.count("1.41 ± 0.61") == 2


def test_no_name_ends_in_dots(capsys: pytest.CaptureFixture[str]) -> None:
    name = "a_recording_whose_name_is_longer_than_any_column_can_be_on_eighty_columns_of_text"
    show_table(("run", *HEAD[1:]), [(name, *ROW[1:])])
    assert name in legible(capsys.readouterr().out).replace("\n", "")


@pytest.mark.parametrize("cell", CELLS)
def test_the_wiring_of_a_cell_is_legible(cell: str, capsys: pytest.CaptureFixture[str]) -> None:
    wiring(cell, markdown=False)
    text = legible(capsys.readouterr().out)
    assert all(contract.name in text for contract in cell_part(cell, "contracts"))


def test_measures_are_legible_and_say_that_the_recording_has_other_goals(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    writer = GoalWriter(tmp_path)
    for start in (2.0, 5.0):
        writer.write_goal(start, OUTCOME)
    writer.close()
    run = load_run(tmp_path)
    measures = measure(run)
    show(Evaluation(run, measures, measure_rows(measures), {}, [], None, tmp_path / "report.html"))
    text = legible(capsys.readouterr().out)
    assert "this recording holds 2 goals, and this is goal 2" in text
    assert "real-time factor" in text


def test_an_error_has_a_colour_on_a_terminal_unless_that_is_not_wanted() -> None:
    assert COLOUR in on_terminal("up", "juggling")
    assert COLOUR not in on_terminal("up", "juggling", NO_COLOR="1")


def test_the_line_of_progress_fits_at_its_longest() -> None:
    slow = Pace(1.0, (0.55,)).remark
    packing = PackObject.Feedback(stage="FINE_TUNE", elapsed=119.9, distance=1.234, iteration_ms=9999.0)
    pallets = [
        Palletize.Feedback(state=state.label, box="00102400-12", placed=10, boxes=12, elapsed=999.9)
        for state in State
    ]
    blocks = Rearrange.Feedback(phase="PERCEIVE", block="b24", done=98, actions=99, elapsed=999.9)
    lines = [
        PackingGoal().progress(packing, 0.55).line,
        *(PalletizingGoal(Path("order.json")).progress(item, 0.55).line for item in pallets),
        BlocksGoal("").progress(blocks, 0.55).line,
    ]
    for line in lines:
        assert len(line + slow) < WIDTH


def on_terminal(*arguments: str, **variables: str) -> str:
    """What a command prints on a terminal of 80 columns."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, "TERM": "xterm-256color", **variables}
    command = [sys.executable, "-c", MAIN, *arguments]
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, env=environment
    )
    os.close(theirs)
    found = bytearray()
    while part := _read(ours):
        found += part
    os.close(ours)
    process.wait()
    return found.decode().replace("\r\n", "\n")


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 65536)
    except OSError:  # how Linux says that the other end has been closed
        return b""
