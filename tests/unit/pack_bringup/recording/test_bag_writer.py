import gc
import random
import shutil
import tracemalloc
from pathlib import Path

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from pack_bringup.recording.bag_copy import copy_bag
from pack_bringup.recording.bag_writer import BagWriter
from pack_bringup.recording.playback import load_playback
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core.bag_topic import Topic
from pack_evaluation.bag import read_bag

NUMBER = "std_msgs/msg/Float64"
TOPICS = (Topic("/numbers", NUMBER), Topic("/silent", NUMBER))
FLUSHES, EACH = 25, 50


def write(folder: Path, *, is_finished: bool = True) -> list[float]:
    """A bag of several files; returns the numbers in it."""
    types, rng = message_types(), random.Random(0)
    values = [rng.random() for _ in range(FLUSHES * EACH)]
    writer = BagWriter(folder / "bag", TOPICS, types, split_size=3000.0)
    for k, value in enumerate(values):
        writer.write(
            "/numbers", 1_000_000 * k, bytes(types.serialize_cdr(types.types[NUMBER](value), NUMBER))
        )
        if k % EACH == EACH - 1:
            writer.flush()
    if is_finished:
        writer.close()
    else:
        writer.abort()
    return values


def numbers(path: Path) -> list[float]:
    return [item.message.data for item in read_bag(path).messages]


def files(folder: Path) -> set[str]:
    return {path.name for path in (folder / "bag").iterdir()}


def test_files_are_numbered_and_each_reads_alone_with_readers_of_mcap(tmp_path: Path) -> None:
    values = write(tmp_path)
    found = sorted((tmp_path / "bag").glob("*.mcap"), key=lambda path: int(path.stem.removeprefix("bag_")))
    assert len(found) > 10  # so that the order of names is not that of numbers
    count = 0
    for path in found:
        with path.open("rb") as file:
            reader = make_reader(file)
            summary = reader.get_summary()
            assert summary is not None
            assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
            count += len(list(reader.iter_messages()))
    assert count == len(values)


def test_metadata_describes_all_files(tmp_path: Path) -> None:
    values = write(tmp_path)
    text = (tmp_path / "bag" / "metadata.yaml").read_text()
    told = yaml.safe_load(text)["rosbag2_bagfile_information"]
    assert set(told["relative_file_paths"]) == files(tmp_path) - {"metadata.yaml"}
    assert told["message_count"] == sum(file["message_count"] for file in told["files"]) == len(values)
    assert told["duration"]["nanoseconds"] == 1_000_000 * (len(values) - 1)
    topics = told["topics_with_message_count"]
    by_topic = {item["topic_metadata"]["name"]: item["message_count"] for item in topics}
    assert by_topic == {"/numbers": len(values), "/silent": 0}


def test_rosbags_evaluation_playback_and_copy_read_a_split_bag_whole(tmp_path: Path) -> None:
    values = write(tmp_path)
    with AnyReader([tmp_path / "bag"]) as reader:
        assert sum(1 for _ in reader.messages()) == len(values)
    assert numbers(tmp_path) == values
    assert not read_bag(tmp_path).is_cut
    assert len(load_playback(tmp_path).messages) == len(values)
    copy_bag(tmp_path, tmp_path / "copy")
    assert numbers(tmp_path / "copy") == values


@pytest.mark.parametrize("leftover", ["no metadata.yaml", "metadata.yaml of the first file"])
def test_all_that_was_flushed_into_a_split_bag_is_read_after_a_kill(tmp_path: Path, leftover: str) -> None:
    write(tmp_path / "whole")
    values = write(tmp_path, is_finished=False)
    assert "bag.mcap" in files(tmp_path)
    assert "metadata.yaml" not in files(tmp_path)
    if leftover != "no metadata.yaml":
        metadata = tmp_path / "bag" / "metadata.yaml"
        shutil.copy(tmp_path / "whole" / "bag" / "metadata.yaml", metadata)
        told = yaml.safe_load(metadata.read_text())
        told["rosbag2_bagfile_information"]["relative_file_paths"] = ["bag_0.mcap"]
        metadata.write_text(yaml.safe_dump(told).replace("bag_1.mcap", ""))
    assert numbers(tmp_path) == values
    assert read_bag(tmp_path).is_cut


def test_a_bag_that_was_not_split_has_one_file_without_a_number(tmp_path: Path) -> None:
    BagWriter(tmp_path / "bag", TOPICS, message_types(), split_size=float("inf")).close()
    assert files(tmp_path) == {"bag.mcap", "metadata.yaml"}
    assert numbers(tmp_path) == []


def test_what_is_kept_in_memory_of_a_finished_file_is_little(tmp_path: Path) -> None:
    """Whatever the number of topics: a recorder that runs for days finishes thousands of files."""
    topics = tuple(Topic(f"/numbers_{k}", NUMBER) for k in range(40))
    types = message_types()
    data = bytes(types.serialize_cdr(types.types[NUMBER](1.0), NUMBER))
    writer = BagWriter(tmp_path / "bag", topics, types, split_size=1.0)

    def kept_after(files: int) -> int:
        for k in range(files):
            writer.write("/numbers_0", k, data)
            writer.flush()
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        first = kept_after(4)  # caches of the libraries fill with the first files
        assert kept_after(10) - first < 10 * 4000
    finally:
        tracemalloc.stop()
        writer.close()
