from pathlib import Path

import pytest

from pack_core.errors import BagError
from pack_evaluation.bag import read_bag


def test_a_run_its_bag_and_its_file_read_the_same(recording: Path) -> None:
    counts = read_bag(recording).counts()
    assert counts["/joint_states"] == 101
    assert read_bag(recording / "bag").counts() == counts
    assert read_bag(recording / "bag" / "bag.mcap").counts() == counts


def test_a_bag_cut_anywhere_gives_a_beginning_of_the_whole(recording: Path, tmp_path: Path) -> None:
    data = (recording / "bag" / "bag.mcap").read_bytes()
    whole = [item.time_ns for item in read_bag(recording).messages]
    cut = tmp_path / "cut.mcap"
    lengths = []
    for end in range(2000, len(data) - 1, len(data) // 40):
        cut.write_bytes(data[:end])
        try:
            bag = read_bag(cut)
        except BagError:
            lengths.append(0)
            continue
        times = [item.time_ns for item in bag.messages]
        assert bag.is_cut
        assert times == whole[: len(times)]
        lengths.append(len(times))
    assert lengths == sorted(lengths)
    assert lengths[-1] == len(whole)
    assert len(set(lengths)) > 10


def test_a_finished_bag_without_its_metadata_file_is_not_called_cut(recording: Path, tmp_path: Path) -> None:
    (tmp_path / "bag.mcap").write_bytes((recording / "bag" / "bag.mcap").read_bytes())
    bag = read_bag(tmp_path)
    assert not bag.is_cut
    assert bag.counts() == read_bag(recording).counts()


def test_only_the_topics_asked_for_are_read(recording: Path) -> None:
    assert set(read_bag(recording, ["/wrench"]).counts()) == {"/wrench"}


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(BagError, match="nowhere does not exist; give a run's folder"):
        read_bag(tmp_path / "nowhere")


def test_a_folder_without_a_bag_is_named(tmp_path: Path) -> None:
    with pytest.raises(BagError, match=r"has no metadata.yaml and no .mcap file"):
        read_bag(tmp_path)


@pytest.mark.parametrize("content", [b"", b"no bag at all", b"\x89MCAP0\r\n"])
def test_a_broken_file_is_refused_in_words(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "bag.mcap").write_bytes(content)
    with pytest.raises(BagError, match="holds no readable recording"):
        read_bag(tmp_path / "bag.mcap")
