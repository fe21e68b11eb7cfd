"""A damaged recording: what is whole is read, what is not is counted, and no length field is believed."""

import random
import resource
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzz.mutations import mutated
from pack_core.errors import BagError
from pack_evaluation.bag import Bag, read_bag
from pack_evaluation.mcap_file import HEAD, Opcode, read_mcap
from pack_evaluation.packing.from_bag import load_run


@pytest.fixture(scope="module")
def data(recording: Path) -> bytes:
    """An MCAP file of many chunks."""
    return (recording / "bag" / "bag.mcap").read_bytes()


def chunks(data: bytes) -> list[tuple[int, int]]:
    """Where every chunk's record begins and ends."""
    found, position = [], 8
    while position < len(data) - 8:
        kind, length = HEAD.unpack_from(data, position)
        if kind == Opcode.CHUNK:
            found.append((position, position + HEAD.size + length))
        position += HEAD.size + length
    return found


def read(tmp_path: Path, data: bytes) -> Bag:
    (tmp_path / "bag.mcap").write_bytes(data)
    return read_bag(tmp_path / "bag.mcap")


def test_a_broken_chunk_is_left_out_and_counted(data: bytes, tmp_path: Path) -> None:
    whole = read(tmp_path, data)
    assert whole.damaged == 0
    (start, end), *_ = chunks(data)[5:]
    spoiled = bytearray(data)
    spoiled[(start + end) // 2] ^= 0x10  # a single bit of what is compressed
    found = read(tmp_path, bytes(spoiled))
    assert (found.damaged, found.is_cut) == (1, False)
    assert 0 < len(whole.messages) - len(found.messages) < 0.2 * len(whole.messages)
    assert {item.time_ns for item in found.messages} < {item.time_ns for item in whole.messages}


def test_reading_goes_on_behind_a_record_with_a_wrong_length(data: bytes, tmp_path: Path) -> None:
    whole = read(tmp_path, data)
    start, _ = chunks(data)[3]
    spoiled = bytearray(data)
    spoiled[start + 1 : start + HEAD.size] = b"\xff" * 8
    found = read(tmp_path, bytes(spoiled))
    assert found.damaged == 1
    assert len(found.messages) > 0.8 * len(whole.messages)
    assert found.messages[-1].time_ns == whole.messages[-1].time_ns


def test_topics_are_known_from_the_index_where_the_first_chunk_is_broken(data: bytes, tmp_path: Path) -> None:
    start, end = chunks(data)[0]
    spoiled = bytearray(data)
    spoiled[start + 60 : end] = bytes(end - start - 60)
    found = read(tmp_path, bytes(spoiled))
    assert found.damaged == 1
    assert "/joint_states" in found.counts()


def test_a_chunk_that_claims_to_be_huge_takes_no_memory(data: bytes) -> None:
    spoiled = bytearray(data)
    for start, _ in chunks(data):
        sizes = start + HEAD.size + 16  # behind the times of the first and the last message
        spoiled[sizes : sizes + 8] = (2**40).to_bytes(8, "little")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    content = read_mcap(bytes(spoiled))
    assert (content.messages, content.damaged) == ([], len(chunks(data)))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # [kB]


def refusal(path: Path) -> str:
    """Why the bag is not read; empty if it is."""
    try:
        load_run(path)
    except BagError as error:
        return str(error)
    return ""


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32))
def test_whatever_is_done_to_a_file_it_is_read_or_refused_by_its_name(data, tmp_path, seed: int) -> None:
    path = tmp_path / "bag.mcap"
    path.write_bytes(mutated(data, "binary", random.Random(seed)))
    assert not (said := refusal(path)) or str(path) in said
