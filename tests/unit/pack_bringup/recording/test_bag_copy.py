from pathlib import Path

import pytest

from pack_bringup.recording.bag_copy import copy_bag
from pack_core.errors import BagError
from pack_evaluation.bag import read_bag
from pack_evaluation.raw_bag import read_raw_bag
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    writer = GoalWriter(tmp_path / "run")
    writer.write_goal(1.0, OUTCOME)
    writer.close()
    return tmp_path / "run"


def test_a_copy_holds_the_same_messages_and_topics(recording: Path, tmp_path: Path) -> None:
    copy_bag(recording, tmp_path / "copy")
    before, after = read_raw_bag(recording), read_raw_bag(tmp_path / "copy")
    assert after.messages == before.messages
    assert after.topics == before.topics


def test_a_stretch_keeps_the_description_whatever_its_time(recording: Path, tmp_path: Path) -> None:
    copy_bag(recording, tmp_path / "copy", start=1.205, end=1.405)
    counts = read_bag(tmp_path / "copy").counts()
    assert counts["/cell_description"] == 1
    assert counts["/joint_states"] == 20


def test_topics_that_are_not_asked_for_are_left_out(recording: Path, tmp_path: Path) -> None:
    copy_bag(recording, tmp_path / "copy", topics=["/wrench"])
    assert set(read_raw_bag(tmp_path / "copy").topics) == {"/wrench"}


def test_a_copy_of_a_bag_that_was_cut_off_is_finished(recording: Path, tmp_path: Path) -> None:
    data = (recording / "bag" / "bag.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[:-20])
    copied = copy_bag(cut, tmp_path / "copy")
    assert copied.was_cut
    assert copied.messages > 0
    assert not read_bag(tmp_path / "copy").is_cut
    assert (tmp_path / "copy" / "metadata.yaml").is_file()


def test_an_existing_target_is_not_written_over(recording: Path) -> None:
    with pytest.raises(BagError, match="exists already"):
        copy_bag(recording, recording)


def test_an_end_before_the_start_is_refused(recording: Path, tmp_path: Path) -> None:
    with pytest.raises(BagError, match="from 5 s to 2 s"):
        copy_bag(recording, tmp_path / "copy", start=5.0, end=2.0)
