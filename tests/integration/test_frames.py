"""What viewers get from each cell's simulator: frames, the robot's description, shapes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from pack_interfaces.srv import ResetScene

from integration.harness import Graph
from integration.palletizing.pallet_rig import spawn
from integration.simulation_rig import pause
from pack_core.ros.contracts import packing, shared
from pack_core.ros.messages.conversions import from_stamp, to_stamp
from pack_core.rotations import Pose
from pack_sim.blocks.blocks_sim_node import BlocksSimNode
from pack_sim.packing.sim_node import PackingSimNode
from pack_sim.palletizing.pallet_sim_node import PalletSimNode
from pack_sim.ros.physics_node import PhysicsNode


@dataclass(frozen=True)
class Expected:
    """A cell's simulator, and some of the frames and markers that it must have."""

    make: Callable[..., PhysicsNode]
    frames: tuple[str, ...]
    shapes: tuple[str, ...]


CELLS = {
    "packing": Expected(
        partial(PackingSimNode), ("tool", "cup", "tip", "container", "table", "mocap_camera_6", "passata"),
        ("passata", "soup_can", "world"),
    ),
    "palletizing": Expected(
        partial(PalletSimNode), ("tool", "pallet", "pallet_deck", "picking_table", "overhead_camera", "box"),
        ("box", "pallet", "picking_table"),
    ),
    "blocks": Expected(
        partial(BlocksSimNode), ("tool", "table", "workspace", "overhead_camera", "finger_left"),
        ("world", "block_b1"),
    ),
}  # fmt: skip


class Viewer:
    """Keeps the newest transform of every frame, as tf2 does."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        graph.probe.listen(shared.TF, shared.TF_STATIC, shared.ROBOT_DESCRIPTION, shared.CELL_MARKERS)

    def transforms(self) -> dict[str, Any]:
        """The newest transform by its frame."""
        mail = self._graph.probe.mail
        messages = [*mail[shared.TF_STATIC.name], *mail[shared.TF.name]]
        return {t.child_frame_id: t for message in messages for t in message.transforms}

    def pose(self, frame: str) -> Pose:
        """X_WF by going from frame to parent up to the world."""
        transforms, X = self.transforms(), Pose(np.zeros(3))
        while frame != "world":
            t = transforms[frame].transform
            p, q = t.translation, t.rotation
            X = Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z])) @ X
            frame = transforms[frame].header.frame_id
        return X

    def frames_of_markers(self) -> set[str]:
        """The frames that the newest markers are in."""
        newest = self.newest(shared.CELL_MARKERS)
        return {marker.header.frame_id for marker in newest.markers} if newest else set()

    def newest(self, contract: Any) -> Any:
        return self._graph.probe.last(contract)


@pytest.fixture(params=CELLS)
def cell(request: pytest.FixtureRequest) -> Expected:
    return CELLS[request.param]


def start(graph: Graph, cell: Expected, factor: float = 0.5) -> tuple[PhysicsNode, Viewer]:
    viewer = Viewer(graph)
    node = graph.start(cell.make, real_time_factor=factor)
    if isinstance(node, PalletSimNode):
        assert spawn(graph, "box").success
    graph.wait_until(lambda: set(cell.frames) <= viewer.transforms().keys())
    return node, viewer


def test_frames_hang_from_the_world_are_where_the_simulator_has_them_and_are_those_that_are_named(
    graph: Graph, cell: Expected
) -> None:
    """Named by the robot's description and by the markers."""
    node, viewer = start(graph, cell)
    _assert_that_named_frames_are_there(graph, cell, viewer)
    pause(graph)
    data = node.simulator.data
    for frame in viewer.transforms():
        X_WF, body = viewer.pose(frame), frame.replace("block_", "block ")
        if body in {data.body(i).name for i in range(1, node.simulator.model.nbody)}:
            np.testing.assert_allclose(X_WF.p, data.body(body).xpos, atol=1e-3)
            assert abs(X_WF.q @ data.body(body).xquat) > 1.0 - 1e-5


def _assert_that_named_frames_are_there(graph: Graph, cell: Expected, viewer: Viewer) -> None:
    # what came before an object did does not name it
    graph.wait_until(
        lambda: viewer.newest(shared.ROBOT_DESCRIPTION) and set(cell.shapes) <= viewer.frames_of_markers()
    )
    frames = {"world", *viewer.transforms()}
    robot = ElementTree.fromstring(viewer.newest(shared.ROBOT_DESCRIPTION).data)
    links = {str(link.get("name")) for link in robot.iter("link")}
    assert len(links) > 7
    assert links <= frames
    first, *markers = viewer.newest(shared.CELL_MARKERS).markers
    assert first.action == first.DELETEALL
    shown = viewer.frames_of_markers() - {""}  # the first, which deletes, is in none
    assert shown <= frames
    assert all(marker.frame_locked and marker.color.a > 0 for marker in markers)
    assert not shown & (links - {"world"})  # the robot is drawn from its description


def test_a_cell_at_rest_sends_its_frames_about_once_a_second_only(graph: Graph, cell: Expected) -> None:
    node, _ = start(graph, cell, factor=2.0)
    graph.wait_until(lambda: node.simulator.data.time > 1.5)  # objects have settled, fingers have opened
    begun = node.simulator.data.time

    def sizes() -> list[int]:
        """Number of frames in each message of 2.2 s that has been heard."""
        mail = [message.transforms for message in graph.probe.mail[shared.TF.name]]
        return [len(sent) for sent in mail if begun < from_stamp(sent[0].header.stamp) <= begun + 2.2]

    graph.wait_until(lambda: node.simulator.data.time > begun + 2.2)
    graph.wait_until(lambda: sum(sizes()) >= 2 * max(sizes(), default=1))  # at once, but for the last message
    assert sum(sizes()) < 8 * max(sizes())


def test_a_reset_moves_the_container_s_frame_and_shows_the_new_objects(graph: Graph) -> None:
    node, viewer = start(graph, CELLS["packing"])
    markers = len(graph.probe.mail[shared.CELL_MARKERS.name])
    assert graph.call(packing.RESET, ResetScene.Request(seed=7)).success
    graph.wait_until(lambda: len(graph.probe.mail[shared.CELL_MARKERS.name]) > markers)
    centre = node.simulator.data.geom("wall_left").xpos[0]  # walls stand along x around the centre
    assert viewer.pose("container").p[0] == pytest.approx(centre)


def test_the_frame_of_the_wrench_is_one_of_them(graph: Graph) -> None:
    graph.probe.listen(packing.WRENCH)
    _, viewer = start(graph, CELLS["packing"])
    graph.wait_until(lambda: graph.probe.last(packing.WRENCH))
    wrench = graph.probe.last(packing.WRENCH)
    assert wrench.header.frame_id in viewer.transforms()
    held, tip = viewer.pose("passata"), viewer.pose(wrench.header.frame_id)
    assert abs(held.q @ tip.q) > 1.0 - 1e-4
    np.testing.assert_allclose(held.apply([0.0, 0.0, 0.09]), tip.p, atol=2e-3)
    assert to_stamp(0.0) != wrench.header.stamp
