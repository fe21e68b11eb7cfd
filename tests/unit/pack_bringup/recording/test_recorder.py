import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_share_directory
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import Reader

from pack_bringup.recording.recorder import Recorder
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core.bag_topic import Topic
from pack_core.errors import BagError
from pack_evaluation.bag import read_bag

NUMBER = "std_msgs/msg/Float64"
NUMBERS = Topic("/numbers", NUMBER)
SCENE = "pack_interfaces/msg/SceneState"
QOS = Qos(
    QosHistory.KEEP_LAST, 7, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL,
    QosTime(1, 0), QosTime(1, 0), QosLiveliness.AUTOMATIC, QosTime(1, 0), False,
)  # fmt: skip

WRITER = """
import sys
import time
from pathlib import Path
from threading import Event
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_bringup.recording.recorder import Recorder
from pack_core.bag_topic import Topic

types = message_types()
recorder = Recorder(Path(sys.argv[1]), [Topic("/numbers", "std_msgs/msg/Float64")], types)
Number, clock, k = types.types["std_msgs/msg/Float64"], Event(), 0
while not recorder.fault:
    for _ in range(10):
        message = types.serialize_cdr(Number(float(k)), "std_msgs/msg/Float64")
        recorder.write("/numbers", 10_000_000 * k, bytes(message))
        k += 1
    print(k, flush=True)
    clock.wait(0.1)
print(recorder.fault, flush=True)
recorder.close()
print("survived", flush=True)
"""
LIMITED = "import resource, signal\nsignal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
LIMITED += "resource.setrlimit(resource.RLIMIT_FSIZE, (8000, 8000))\n"


def write_numbers(recorder: Recorder, count: int) -> None:
    types = message_types()
    for k in range(count):
        message = types.serialize_cdr(types.types[NUMBER](float(k)), NUMBER)
        recorder.write("/numbers", 1000 * k, bytes(message))


def start(code: str, bag: Path) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-c", code, str(bag)], stdout=subprocess.PIPE, text=True)


def lines_of(process: subprocess.Popen[str]) -> list[str]:
    assert process.stdout is not None
    return process.stdout.read().splitlines()


def test_what_was_written_is_read_back_in_order(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "bag", [NUMBERS], message_types())
    write_numbers(recorder, 500)
    recorder.close()
    bag = read_bag(tmp_path)
    assert not bag.is_cut
    assert [(item.time_ns, item.message.data) for item in bag.messages] == [
        (1000 * k, float(k)) for k in range(500)
    ]


def test_a_bag_carries_whole_schemas_qos_and_the_type_hashes_of_the_graph(tmp_path: Path) -> None:
    Recorder(tmp_path / "bag", [Topic("/scene", SCENE, (QOS,))], message_types()).close()
    with Reader(tmp_path / "bag") as reader:
        (connection,) = reader.connections
    description = Path(get_package_share_directory("pack_interfaces"), "msg", "SceneState.json")
    hashes = json.loads(description.read_text())["type_hashes"]
    assert connection.digest == hashes[0]["hash_string"]
    assert connection.ext.offered_qos_profiles == [QOS]
    assert "MSG: pack_interfaces/ObjectState" in connection.msgdef.data
    assert "version: 9" in (tmp_path / "bag" / "metadata.yaml").read_text()


def test_a_killed_recording_loses_at_most_half_a_second(tmp_path: Path) -> None:
    process = start(WRITER, tmp_path / "bag")
    assert process.stdout is not None
    handed_over = next(int(line) for line in process.stdout if int(line) >= 250)
    process.send_signal(signal.SIGKILL)
    process.wait()
    bag = read_bag(tmp_path)
    assert bag.is_cut
    numbers = [item.message.data for item in bag.messages]
    assert numbers == [float(k) for k in range(len(numbers))]
    assert handed_over - len(numbers) <= 50


def test_a_full_disk_is_a_fault_that_the_process_survives_and_the_bag_stays_readable(tmp_path: Path) -> None:
    process = start(LIMITED + WRITER, tmp_path / "bag")
    *counts, fault, last = lines_of(process)
    assert process.wait() == 0
    assert last == "survived"
    assert "File too large" in fault
    assert str(tmp_path / "bag") in fault
    bag = read_bag(tmp_path)
    assert bag.is_cut
    assert 0 < len(bag.messages) <= int(counts[-1])


def test_an_existing_folder_is_not_written_over(tmp_path: Path) -> None:
    (tmp_path / "bag").mkdir()
    with pytest.raises(BagError, match=r"exists already.*another `path`"):
        Recorder(tmp_path / "bag", [NUMBERS], message_types())


def test_a_folder_that_cannot_be_made_is_refused_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(BagError, match=r"Not a directory.*another `path`"):
        Recorder(tmp_path / "file" / "bag", [NUMBERS], message_types())


def wait_for_fault(recorder: Recorder) -> str:
    deadline = time.monotonic() + 20.0
    while not recorder.fault:
        assert time.monotonic() < deadline, "no fault was noticed"
        time.sleep(0.01)
    return recorder.fault


def test_a_recording_ends_whole_at_its_limit_and_says_so(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "bag", [NUMBERS], message_types(), limit=100.0)
    write_numbers(recorder, 10)
    fault = wait_for_fault(recorder)
    assert "limit" in fault
    assert "limit_gb" in fault
    write_numbers(recorder, 5)
    recorder.close()
    bag = read_bag(tmp_path)
    # How many are written before the limit is noticed hangs on how many the writer found waiting.
    assert bag.messages
    assert not bag.is_cut
    assert recorder.dropped >= 5
    assert len(bag.messages) + recorder.dropped == 15


def test_a_bag_that_is_removed_while_it_is_written_is_noticed(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "bag", [NUMBERS], message_types())
    write_numbers(recorder, 3)
    (tmp_path / "bag").rename(tmp_path / "moved")
    assert "removed or renamed" in wait_for_fault(recorder)
    write_numbers(recorder, 3)
    recorder.close()
    assert recorder.dropped >= 3


def test_a_message_that_cannot_be_written_is_a_fault_that_is_told(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "bag", [NUMBERS], message_types())
    write_numbers(recorder, 3)
    recorder.write("/numbers", -1, b"")  # no bag has times before 0
    assert "stopped" in wait_for_fault(recorder)
    recorder.close()
