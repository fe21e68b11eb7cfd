"""Boxes that come and go, the gripper and the camera, on command."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import numpy as np
import pytest
import yaml
from pack_interfaces.srv import GripperCommand, LayOnTable, RemoveBox, ResetCell, SpawnBox
from std_srvs.srv import Trigger

from integration.harness import PATIENCE, Graph
from integration.palletizing.pallet_rig import newest_joints, spawn, start_pallet_sim
from pack_core.camera import Picture
from pack_core.palletizing.cell import palletizing_cell
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import from_stamp, to_pose
from pack_core.ros.messages.scene import from_scene
from pack_core.rotations import Pose
from pack_sim.palletizing.overhead_camera import PalletCamera, Snapshot


def boxes_of(graph: Graph) -> dict[str, Pose]:
    return from_scene(graph.probe.last(contracts.TRUTH)).poses()


def reason(graph: Graph) -> str:
    return str(graph.probe.last(contracts.GRIPPER_STATE).release_reason)


def test_a_box_arrives_and_everyone_is_told(graph: Graph) -> None:
    start_pallet_sim(graph)
    assert spawn(graph).success
    graph.wait_until(lambda: "box" in boxes_of(graph))
    offset = boxes_of(graph)["box"].p[:2] - palletizing_cell().picking_table.centre
    assert np.all(np.abs(offset) <= palletizing_cell().spawn.offset)
    (row,) = yaml.safe_load(graph.probe.last(contracts.BOXES).data)
    assert row == {"name": "box", "size": [0.4, 0.3, 0.25], "mass": 8.0}


def test_a_box_that_cannot_come_is_refused_with_the_reason(graph: Graph) -> None:
    start_pallet_sim(graph)
    assert spawn(graph).success
    assert "box 'box' is in the cell already" in spawn(graph).message
    assert "no room for box 'other': box is in its place" in spawn(graph, "other").message
    request = SpawnBox.Request(name="thin", size=np.array([0.4, 0.3, 0.0]), mass=1.0)
    response = graph.call(contracts.SPAWN_BOX, request)
    assert not response.success
    assert "three extents and a mass above 0" in response.message


def test_what_the_operator_lays_on_the_table_is_some_millimetres_from_where_it_was_asked_for(
    graph: Graph,
) -> None:
    start_pallet_sim(graph)
    X_NB = Pose(palletizing_cell().picking_table.middle + np.array([0.0, 0.0, 0.1]))
    request = LayOnTable.Request(name="test box", size=[0.4, 0.3, 0.2], mass=8.0, pose=to_pose(X_NB))
    assert graph.call(contracts.LAY_ON_TABLE, request).success
    graph.wait_until(lambda: "test box" in boxes_of(graph))
    off = boxes_of(graph)["test box"].p - X_NB.p
    assert 0.001 < np.linalg.norm(off) < 0.01
    assert "'test box' is in the cell already" in graph.call(contracts.LAY_ON_TABLE, request).message


def test_a_box_is_removed_and_the_cell_is_reset(graph: Graph) -> None:
    start_pallet_sim(graph)
    assert spawn(graph).success
    assert graph.call(contracts.REMOVE_BOX, RemoveBox.Request(name="box")).success
    assert (
        "no box 'box' in the cell" in graph.call(contracts.REMOVE_BOX, RemoveBox.Request(name="box")).message
    )
    assert spawn(graph).success
    before = newest_joints(graph).time
    assert graph.call(contracts.RESET, ResetCell.Request(seed=4)).success
    graph.wait_until(lambda: graph.probe.last(contracts.BOXES).data.strip() == "[]")
    graph.wait_until(lambda: newest_joints(graph).time > before + 0.1)
    np.testing.assert_allclose(newest_joints(graph).q, palletizing_cell().arm.home, atol=1e-4)


def test_a_gripper_without_a_box_says_that_it_found_none(graph: Graph) -> None:
    start_pallet_sim(graph, 1.0)
    mail = graph.probe.mail[contracts.GRIPPER_STATE.name]
    known = len(mail)
    assert graph.call(contracts.GRIPPER_COMMAND, GripperCommand.Request(close=True)).success
    graph.wait_until(lambda: "no box within 10 mm" in reason(graph))
    assert "" in [state.release_reason for state in mail[known:]]  # it tried for a while
    assert not any(state.is_closed for state in mail[known:])


class HeldDrawing:
    """The camera's drawing, which begins when a test lets it."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.begins = threading.Event()
        draw = PalletCamera.picture

        def picture(camera: PalletCamera, snapshot: Snapshot) -> Picture:
            self.begins.wait(PATIENCE)
            return draw(camera, snapshot)

        patch.setattr(PalletCamera, "picture", picture)


@pytest.fixture
def drawing(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> Iterator[HeldDrawing]:
    held = HeldDrawing(monkeypatch)
    yield held
    held.begins.set()  # before the graph is closed, which waits for the picture


def test_a_triggered_picture_follows_with_its_time_and_the_intrinsics(
    graph: Graph, drawing: HeldDrawing
) -> None:
    sim = start_pallet_sim(graph)
    graph.probe.listen(contracts.IMAGE, contracts.CAMERA_INFO)
    assert spawn(graph).success
    before = sim.simulator.time
    assert graph.call(contracts.TRIGGER, Trigger.Request()).success
    after = sim.simulator.time
    assert "still being made" in graph.call(contracts.TRIGGER, Trigger.Request()).message
    drawing.begins.set()
    heard = (contracts.IMAGE, contracts.CAMERA_INFO)
    graph.wait_until(lambda: all(graph.probe.last(contract) for contract in heard), timeout=60.0)
    image, info = (graph.probe.last(contract) for contract in heard)
    assert (image.width, image.height) == (info.width, info.height) == (640, 360)
    assert image.encoding == "rgb8"
    assert len(image.data) == 3 * 640 * 360
    assert before - 1e-6 < from_stamp(image.header.stamp) < after + 1e-6
    f = palletizing_cell().overhead_camera.scaled(640).f
    np.testing.assert_allclose(info.k[[0, 4]], f)


@pytest.mark.parametrize("rate", [20.0, 250.0])  # 250 Hz: a frame is due whenever one is asked for
def test_a_frame_that_is_lost_to_the_last_picture_is_made_up_for_by_a_later_one(
    graph: Graph, drawing: HeldDrawing, rate: float
) -> None:
    sim = start_pallet_sim(graph, **{"camera.rate": rate})
    graph.probe.listen(contracts.IMAGE)
    for _ in range(2):  # the second frame comes while the first picture is still being drawn
        assert graph.call(contracts.TRIGGER, Trigger.Request()).success
        asked = sim.simulator.time
        graph.wait_until(lambda: newest_joints(graph).time > asked + 0.06)  # noqa: B023
    drawing.begins.set()
    graph.wait_until(lambda: len(graph.probe.mail[contracts.IMAGE.name]) == 2, timeout=60.0)


def test_a_picture_does_not_hold_up_the_physics(graph: Graph, drawing: HeldDrawing) -> None:
    """Clock ticks go on while a picture is drawn."""
    start_pallet_sim(graph)
    graph.probe.listen(contracts.IMAGE)
    assert graph.call(contracts.TRIGGER, Trigger.Request()).success
    seen = newest_joints(graph).time
    graph.wait_until(lambda: newest_joints(graph).time > seen + 0.05)
    assert graph.probe.last(contracts.IMAGE) is None
    drawing.begins.set()
    graph.wait_until(lambda: graph.probe.last(contracts.IMAGE), timeout=60.0)
