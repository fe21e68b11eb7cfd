"""The vision node: a picture and an expected box in, a detection or a refusal and pictures of it out."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest

from integration.harness import Graph
from pack_core.camera import Picture, PinholeCamera
from pack_core.palletizing.boxes import BoxBody, BoxDetection, DetectionStatus, ExpectedBox
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.camera import to_camera_info, to_image
from pack_core.ros.messages.palletizing import from_detection, to_expected_box
from pack_core.rotations import Pose, from_yaw
from pack_perception.boxes.box_vision_node import BoxVisionNode
from unit.pack_perception.boxes.spawns import CELL, NOMINAL, TABLE, LitView, Spawn, errors

FULL = CELL.overhead_camera
CAMERA = PinholeCamera.looking_down(FULL.X_WC.p, FULL.f / 2, FULL.width // 2, FULL.height // 2)
DIMS = (0.4, 0.3, 0.2)
SPAWN = Spawn("box", DIMS, Pose([-2.45, 2.53, TABLE.height + 0.1], from_yaw(0.1)))
INPUTS = (contracts.CAMERA_INFO, contracts.EXPECTED_BOX, contracts.IMAGE)
IMAGES = (contracts.VISION_FRAME, contracts.VISION_ROI, contracts.VISION_MASK, contracts.VISION_OVERLAY)


@pytest.fixture(scope="module")
def picture() -> Iterator[Picture]:
    with LitView(NOMINAL, CAMERA.width, CAMERA.height) as view:
        body = BoxBody(SPAWN.id, SPAWN.dims, 5.0)
        yield view.picture(np.array(CELL.arm.home), {body: SPAWN.X_WB}, CAMERA).copy()


@dataclass
class Rig:
    """The node and what a simulator and a state machine would send it."""

    graph: Graph
    node: BoxVisionNode

    def expect(self, time: float, dims: tuple[float, float, float] = DIMS) -> None:
        self.graph.probe.send(contracts.EXPECTED_BOX, to_expected_box(ExpectedBox("box", dims, time)))

    def show(self, time: float, picture: Picture) -> None:
        self.graph.probe.send(contracts.CAMERA_INFO, to_camera_info(time, CAMERA, "camera"))
        self.graph.probe.send(contracts.IMAGE, to_image(time, picture, "camera"))

    def answer(self) -> BoxDetection:
        self.graph.wait_until(lambda: self.graph.probe.last(contracts.BOX_DETECTION))
        return from_detection(self.graph.probe.last(contracts.BOX_DETECTION))


@pytest.fixture
def rig(graph: Graph, tmp_path: Path) -> Rig:
    graph.probe.listen(contracts.BOX_DETECTION, *IMAGES)
    node = graph.start(BoxVisionNode, pictures=str(tmp_path / "pictures"))
    graph.connect(*INPUTS)
    return Rig(graph, node)


def test_the_expected_box_is_found_in_the_picture(rig: Rig, picture: Picture, tmp_path: Path) -> None:
    rig.expect(1.0)
    rig.show(1.5, picture)
    detection = rig.answer()
    assert detection.status is DetectionStatus.DETECTED, detection.reason
    assert (detection.time, detection.box_id) == (1.5, "box")
    off_mm, off_deg = errors(detection, SPAWN)
    assert off_mm < 0.5
    assert off_deg < 0.1
    rig.graph.wait_until(lambda: all(rig.graph.probe.last(contract) for contract in IMAGES))
    overlay = rig.graph.probe.last(contracts.VISION_OVERLAY)
    assert cv2.imdecode(np.frombuffer(overlay.data, np.uint8), cv2.IMREAD_COLOR).shape[2] == 3
    assert len(list((tmp_path / "pictures").glob("*_box_*.png"))) == 4


def test_another_box_is_refused_and_told(rig: Rig, picture: Picture) -> None:
    rig.expect(1.0, (0.45, 0.3, 0.2))
    rig.show(1.5, picture)
    detection = rig.answer()
    assert detection.status is DetectionStatus.WRONG_SIZE
    assert detection.X_WB is None
    assert detection.size[0] == pytest.approx(0.4, abs=0.002)
    assert "box 'box' has 450.0 x 300.0 mm" in detection.reason
    assert rig.node.health.counts["refused detection"] == 1


def test_pictures_from_before_the_box_came_are_not_used(rig: Rig, picture: Picture) -> None:
    rig.expect(2.0)
    rig.show(1.9, picture)
    rig.show(2.1, picture)
    assert rig.answer().time == 2.1
    assert len(rig.graph.probe.mail[contracts.BOX_DETECTION.name]) == 1


def test_messages_that_must_not_be_used_are_dropped_and_counted(rig: Rig, picture: Picture) -> None:
    counts = rig.node.health.counts
    rig.graph.probe.send(contracts.EXPECTED_BOX, to_expected_box(ExpectedBox("box", (0.1, 0.3, 0.2), 1.0)))
    rig.graph.wait_until(lambda: counts["refused /expected_box"] == 1)
    rig.expect(0.5)
    rig.show(1.0, picture[::2, ::2].copy())  # not of the camera's size
    rig.graph.wait_until(lambda: refusals(counts) == 1)
    grey = to_image(1.1, picture, "camera")
    grey.encoding = "mono8"
    rig.graph.probe.send(contracts.IMAGE, grey)
    rig.graph.wait_until(lambda: refusals(counts) == 2)
    rig.show(1.5, picture)
    assert rig.answer().status is DetectionStatus.DETECTED


def refusals(counts: Counter[str]) -> int:
    """Pictures that were refused, whichever of the messages that belong to them came last."""
    return sum(counts[f"refused {topic.name}"] for topic in INPUTS) - 1  # the box that was refused before
