"""Nodes against a played recording."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from std_msgs.msg import String

from integration.harness import Graph
from pack_bringup.cli.play import heard_by
from pack_bringup.recording.playback import Playback, load_playback
from pack_bringup.recording.ros.bag_player import BagPlayer
from pack_core.errors import BagError, ConfigError
from pack_core.paths import bags_path
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.table import wiring_of
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.scene import from_scene
from pack_core.ros.node import CellNode
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.track import to_tracks
from pack_perception.mocap.perception_node import PerceptionNode

SAMPLE = bags_path() / "samples" / "packing"
RATE = 0.25
"""Slow enough for a busy machine to take every message."""
DURATION = 1.0


@pytest.fixture(scope="module")
def playback() -> Playback:
    """What perception hears in a second of the sample, from before the goal on."""
    return load_playback(SAMPLE, heard=heard_by("perception", wiring_of("packing")), end=1.6 + DURATION)


@contextmanager
def played(graph: Graph, player: BagPlayer) -> Iterator[Future[int]]:
    """Playing in a thread of its own, while the graph is spun here."""
    with ThreadPoolExecutor(1) as thread:
        yield thread.submit(player.play, RATE)


def test_perception_runs_against_a_recording_as_against_the_simulator(
    graph: Graph, playback: Playback
) -> None:
    graph.start(PerceptionNode)
    graph.probe.listen(contracts.SCENE, shared.CLOCK, shared.DIAGNOSTICS)
    domain = graph.context.get_domain_id()
    with BagPlayer(playback, clock=True, stand_in=("sim",), domain=domain) as player:
        graph.wait_until(lambda: not player.unheard)
        graph.wait_until(lambda: graph.probe.count_publishers(shared.CLOCK.name))
        with played(graph, player) as done:
            graph.wait_until(done.done, timeout=30.0)
    assert done.result() == len(playback.messages) + len(playback.early)
    estimated = to_tracks([from_scene(message) for message in graph.probe.mail[contracts.SCENE.name]])
    recorded = load_run(SAMPLE).estimate
    assert estimated.keys() == recorded.keys()
    for name, track in estimated.items():
        window = track.between(2.0, 1.6 + DURATION)
        assert window.times.size > 50
        assert np.percentile(recorded[name].at(window.times).distance_to(window.p), 95) < 1e-3, name


def test_the_played_clock_runs_from_the_first_to_the_last_message(graph: Graph, playback: Playback) -> None:
    graph.probe.listen(shared.CLOCK)
    with BagPlayer(playback, clock=True, domain=graph.context.get_domain_id()) as player:
        graph.wait_until(player._clock.get_subscription_count)
        with played(graph, player) as done:
            graph.wait_until(done.done, timeout=30.0)
            graph.wait_until(lambda: _newest(graph) > playback.end_ns * 1e-9 - 0.005)
    times = [from_stamp(message.clock) for message in graph.probe.mail[shared.CLOCK.name]]
    assert times == sorted(times)
    assert times[0] < playback.start_ns * 1e-9 + 0.1


def _newest(graph: Graph) -> float:
    last = graph.probe.last(shared.CLOCK)
    return from_stamp(last.clock) if last else 0.0


def test_late_joiners_of_its_namespace_get_the_recorded_description(graph: Graph, playback: Playback) -> None:
    looker = graph.start(lambda **kwargs: CellNode("looker", namespace="/left", **kwargs))
    looker.watch(("sim",))
    heard: list[String] = []
    domain = graph.context.get_domain_id()
    with BagPlayer(playback, clock=False, stand_in=("sim",), domain=domain, namespace="/left") as player:
        with played(graph, player) as done:
            graph.wait_until(lambda: looker.hears("sim"))
            graph.wait_until(done.done, timeout=30.0)
        looker.listen(contracts.DESCRIPTION, heard.append)
        graph.probe.listen(contracts.DESCRIPTION)
        graph.wait_until(lambda: heard)
    assert graph.probe.last(contracts.DESCRIPTION) is None, "the cell in no namespace hears nothing of it"


def test_a_message_type_that_has_changed_since_is_refused(playback: Playback) -> None:
    other = get_typestore(Stores.ROS2_JAZZY)
    for topic in playback.topics.values():
        if topic.type.startswith("pack_interfaces"):
            other.register(get_types_from_msg("float64 something_else", topic.type))
    with pytest.raises(BagError, match=r"GripperState of /gripper/state has changed since"):
        BagPlayer(replace(playback, types=other), clock=False)


def test_a_node_hears_what_the_wiring_table_says() -> None:
    assert set(heard_by("perception", wiring_of("packing"))) == {
        contracts.DESCRIPTION.name, contracts.SIM_DESCRIPTION.name, contracts.JOINT_STATES.name,
        contracts.MARKERS.name, contracts.GRIPPER_STATE.name,
        *(contract.name for contract in (*contracts.DEPTH_IMAGES, *contracts.DEPTH_INFOS)),
    }  # fmt: skip
    with pytest.raises(ConfigError, match=r"node 'vision'; allowed: .*perception"):
        heard_by("vision", wiring_of("packing"))
