"""The cell with depth cameras: nobody says what is in the container, and an object is packed into it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from integration.harness import Graph
from integration.packing.cell_rig import Cell
from pack_bringup.recording.recorder_node import RecorderNode
from pack_core.packing.scene import Scene
from pack_core.packing.topics import DEPTH_IMAGES
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.scene import from_scene
from pack_evaluation.bag import read_bag
from pack_evaluation.packing.from_bag import load_run
from pack_lockstep.packing.lockstep_config import load_preset
from pack_lockstep.packing.perception_replay import replay_perception

FACTOR = 0.2


def test_what_nobody_described_is_seen_packed_beside_recorded_and_replayed(
    graph: Graph, tmp_path: Path
) -> None:
    recorder = graph.start(RecorderNode, path=str(tmp_path), cell="packing", record="always")
    graph.probe.listen(contracts.DESCRIPTION, contracts.SIM_DESCRIPTION, contracts.DEPTH_POINTS_3)
    cell = Cell(graph, FACTOR, preset="unknown")
    graph.wait_until(lambda: graph.probe.last(contracts.DESCRIPTION))
    seen = Scene.from_yaml(graph.probe.last(contracts.DESCRIPTION).data)
    told = Scene.from_yaml(graph.probe.last(contracts.SIM_DESCRIPTION).data)
    assert seen.names == ["seen_1", "seen_2"]
    assert seen.new_object.half_extents == pytest.approx(told.new_object.half_extents, abs=0.0005)
    graph.wait_until(lambda: graph.probe.last(contracts.DEPTH_POINTS_3))
    assert graph.probe.last(contracts.DEPTH_POINTS_3).header.frame_id == "depth_3"
    result = graph.result_of(cell.pack(), timeout=120.0)
    assert result.success, result.message
    estimate = from_scene(graph.probe.last(contracts.SCENE))
    assert set(estimate.objects) == {*seen.names, told.new_object.name}
    graph.stop(recorder)

    run = load_run(tmp_path)  # with the true objects' names
    assert set(run.estimate) == {*told.names, told.new_object.name}
    for name in told.names:
        track = run.estimate[name].between(run.start, run.end)
        assert np.median(track.distance_to(run.truth[name].at(track.times).p)) < 0.005

    replay = replay_perception(read_bag(tmp_path), load_preset("unknown"))
    assert replay.inputs.keys() == {*DEPTH_IMAGES}
    assert {row.name for row in replay.rows} == {*seen.names, told.new_object.name}
    assert replay.agrees, replay.rows
