"""What `pack demo` says at its end."""

from pathlib import Path
from types import SimpleNamespace

import pytest
import typer

from pack_bringup.cli import pursue
from pack_bringup.pace import Pace
from pack_bringup.packing.goals import PackingJob, packing_fill_job
from pack_core.errors import BagError, PackError


@pytest.fixture
def ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """A goal that has ended well, without a message."""
    result = SimpleNamespace(success=True, message="")
    monkeypatch.setattr(pursue, "run_demo", lambda *_: (result, Pace(1.0)))


def test_a_report_that_was_interrupted_is_said_to_be_made_by_pack_evaluate(
    ended: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(pursue, "run_evaluation", stop)
    with pytest.raises(typer.Exit) as left:
        pursue.run_live(PackingJob(folder=tmp_path / "run"), video=True)
    assert left.value.exit_code == 130
    said = capsys.readouterr().out
    assert f"pack evaluate {tmp_path / 'run'}" in said
    assert "goal ended: success\n" in said


def test_a_goal_that_failed_before_its_work_began_has_its_reason_and_no_word_of_a_bad_recording(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise BagError("the recording holds no order")

    result = SimpleNamespace(success=False, message="the cell is not calibrated")
    monkeypatch.setattr(pursue, "run_demo", lambda *_: (result, Pace(1.0)))
    monkeypatch.setattr(pursue, "run_evaluation", fail)
    with pytest.raises(typer.Exit) as left:
        pursue.run_live(PackingJob(folder=tmp_path / "run"), video=True)
    assert left.value.exit_code == 1
    said = capsys.readouterr().out
    assert "goal ended: failure, the cell is not calibrated\n" in said
    assert "recording" not in said


def test_a_run_that_is_refused_leaves_no_folder_behind(tmp_path: Path) -> None:
    job = PackingJob(folder=tmp_path / "run", preset="perfect")
    with pytest.raises(PackError, match="no preset 'perfect'"):
        pursue.run_live(job, video=True)
    assert not job.folder.exists()
    job.folder.mkdir()  # which is the user's own
    with pytest.raises(PackError, match="no preset 'perfect'"):
        pursue.run_live(job, video=True)
    assert job.folder.exists()


def test_a_list_whose_conditions_are_refused_leaves_no_folder_behind(tmp_path: Path) -> None:
    missing = tmp_path / "calibration.yaml"
    job = packing_fill_job(
        0, None, folder=tmp_path / "run", preset="", real_time_factor=None, command="", calibration=missing
    )
    with pytest.raises(PackError, match="no such file"):
        pursue.run_live(job, video=True)
    assert not job.folder.exists()


@pytest.mark.parametrize("here", [set(), {"sim", "perception", "planner", "mpc", "recorder"}])
def test_a_goal_for_a_cell_that_does_not_run_is_refused_also_where_another_one_does(
    here: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pursue, "cell_nodes_here", lambda *_: here)
    monkeypatch.setattr(pursue, "running_cells", dict)
    with pytest.raises(PackError, match="no node of the blocks cell runs in ROS domain 7"):
        pursue._check_running("blocks", 7, "/")


@pytest.mark.parametrize("here", [{"fsm"}, {"sim", "tags", "rearrangement", "motion", "fsm", "recorder"}])
def test_a_goal_is_sent_to_a_cell_that_runs_also_in_part(
    here: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pursue, "cell_nodes_here", lambda *_: here)
    pursue._check_running("blocks", 7, "/")
