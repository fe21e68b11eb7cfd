"""Bags as other tools and mishaps leave them: the same is read, or it is said what is not."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
import zstandard
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from pack_core.errors import BagError
from pack_evaluation.bag import read_bag
from pack_evaluation.mcap_file import HEAD

Extra = Callable[[Writer], None]
PARTS = ("bag_0", "bag_1", "bag_2", "bag")


@pytest.fixture(scope="module")
def records(recording: Path) -> list[tuple[Any, Any, Any]]:
    """Schema, channel and message of everything in a recording."""
    with (recording / "bag" / "bag.mcap").open("rb") as file:
        return list(make_reader(file).iter_messages())


def write(
    path: Path, records: list[tuple[Any, Any, Any]], extra: Extra | None = None, **options: Any
) -> Path:
    """An MCAP file of messages; `without`: topics whose definitions are left out."""
    path.parent.mkdir(parents=True, exist_ok=True)
    without = options.pop("without", ())
    with path.open("wb") as file:
        writer = Writer(file, **options)
        writer.start(profile="ros2")
        channels: dict[int, int] = {}
        for schema, channel, message in records:
            if channel.id not in channels:
                text, encoding = (b"", "") if channel.topic in without else (schema.data, schema.encoding)
                number = writer.register_schema(schema.name, encoding, text)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, number, channel.metadata
                )
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time)
        if extra is not None:
            extra(writer)
        writer.finish()
    return path


def tell(folder: Path, *files: str, **about: str) -> None:
    """A metadata.yaml that lists files."""
    information = {"relative_file_paths": list(files), "compression_mode": "", **about}
    (folder / "metadata.yaml").write_text(yaml.safe_dump({"rosbag2_bagfile_information": information}))


def split(folder: Path, records: list[tuple[Any, Any, Any]]) -> None:
    """A bag in four files, as a recorder leaves it that has been killed."""
    n = len(records)
    for k, name in enumerate(PARTS):
        write(folder / f"{name}.mcap", records[k * n // 4 : (k + 1) * n // 4])


def test_a_file_that_the_metadata_does_not_list_is_left_out_by_name(records, tmp_path: Path) -> None:
    write(tmp_path / "bag.mcap", records)
    write(tmp_path / "bag (copy).mcap", records)
    tell(tmp_path, "bag.mcap")
    bag = read_bag(tmp_path)
    assert len(bag.messages) == len(records)
    assert bag.notes == ("bag (copy).mcap was left out: metadata.yaml does not list it",)
    assert bag.damaged == 0


def test_numbered_files_that_follow_those_listed_count_and_are_named(records, tmp_path: Path) -> None:
    split(tmp_path, records)
    tell(tmp_path, "bag_0.mcap")
    bag = read_bag(tmp_path)
    assert len(bag.messages) == len(records)
    assert bag.notes[0] == "bag_1.mcap follows those that metadata.yaml lists, and was read"


def test_a_file_that_the_metadata_lists_twice_is_read_once(records, tmp_path: Path) -> None:
    write(tmp_path / "bag.mcap", records)
    tell(tmp_path, "bag.mcap", "old_folder/bag.mcap")
    assert len(read_bag(tmp_path).messages) == len(records)


def test_a_missing_file_of_a_split_bag_is_damage_and_named(records, tmp_path: Path) -> None:
    split(tmp_path, records)
    tell(tmp_path, *(f"{name}.mcap" for name in PARTS))
    assert len(read_bag(tmp_path).messages) == len(records)
    (tmp_path / "bag_1.mcap").unlink()
    bag = read_bag(tmp_path)
    assert (bag.damaged, bag.notes) == (1, ("bag_1.mcap is missing, which metadata.yaml lists",))


@pytest.mark.parametrize("number", [0, 1])
def test_so_is_a_gap_in_the_numbers_where_nothing_lists_the_files(
    number: int, records, tmp_path: Path
) -> None:
    split(tmp_path, records)
    assert len(read_bag(tmp_path).messages) == len(records)
    (tmp_path / f"bag_{number}.mcap").unlink()
    bag = read_bag(tmp_path)
    assert (bag.damaged, bag.notes) == (1, (f"bag_{number}.mcap is missing",))


def test_files_of_two_recordings_in_one_folder_are_refused(records, tmp_path: Path) -> None:
    for name in ("run_20260101.mcap", "run_20260102.mcap"):
        write(tmp_path / name, records)
    with pytest.raises(BagError, match=r"run_20260101.mcap, run_20260102.mcap have no name in common"):
        read_bag(tmp_path)


def test_metadata_of_another_bag_is_refused(records, tmp_path: Path) -> None:
    write(tmp_path / "renamed.mcap", records)
    tell(tmp_path, "bag.mcap")
    with pytest.raises(BagError, match=r"metadata.yaml lists bag.mcap, but there is renamed.mcap"):
        read_bag(tmp_path)


def test_metadata_that_cannot_be_read_is_as_good_as_none(records, tmp_path: Path) -> None:
    write(tmp_path / "bag.mcap", records)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: [")
    assert len(read_bag(tmp_path).messages) == len(records)


@pytest.mark.parametrize("kind", [0x10, 0x80, 0xFF])
def test_records_of_private_and_later_kinds_are_skipped(kind: int, records, tmp_path: Path) -> None:
    path = write(
        tmp_path / "bag.mcap", records, compression=CompressionType.NONE, use_chunking=False,
        index_types=IndexType.NONE, use_statistics=False, use_summary_offsets=False,
        repeat_channels=False, repeat_schemas=False,
    )  # fmt: skip
    data = path.read_bytes()
    end = 8 + HEAD.size + HEAD.unpack_from(data, 8)[1]
    path.write_bytes(data[:end] + HEAD.pack(kind, 4) + b"note" + data[end:])
    bag = read_bag(path)
    assert (len(bag.messages), bag.damaged, bag.is_cut) == (len(records), 0, False)


def test_topics_of_other_tools_are_left_out_by_name_and_are_no_damage(records, tmp_path: Path) -> None:
    def notes(writer: Writer) -> None:
        channel = writer.register_channel("/notes", "json", 0)
        for k in range(50):
            writer.add_message(channel, k, b'{"text": "ok"}', k)

    bag = read_bag(write(tmp_path / "bag.mcap", records, notes))
    assert (len(bag.messages), bag.damaged) == (len(records), 0)
    assert bag.notes == ("topic /notes was left out: its messages are 'json', not CDR",)


def test_a_missing_definition_is_named(records, tmp_path: Path) -> None:
    bag = read_bag(write(tmp_path / "bag.mcap", records, without=["/wrench"]))
    why = "the recording holds no definition of geometry_msgs/msg/WrenchStamped"
    assert bag.notes == (f"topic /wrench was left out: {why}",)
    assert (bag.of("/wrench"), bag.damaged) == ([], 0)
    assert bag.reason("was its node running?") == bag.notes[0]


def test_messages_that_are_compressed_one_by_one_are_refused_by_that_name(records, tmp_path: Path) -> None:
    write(tmp_path / "bag_0.mcap", records)
    path = tmp_path / "bag_0.mcap"
    path.write_bytes(zstandard.ZstdCompressor().compress(path.read_bytes()))
    tell(tmp_path, "bag_0.mcap", compression_format="zstd", compression_mode="MESSAGE")
    with pytest.raises(BagError, match="compression mode MESSAGE; allowed: FILE or none"):
        read_bag(tmp_path)
