"""Box vision as a ROS 2 node: pictures and the expected box in, its pose or a refusal out."""

from __future__ import annotations

from array import array
from pathlib import Path
from typing import Any

import cv2
from pack_interfaces.msg import ExpectedBox as ExpectedBoxMsg
from pydantic import Field
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from pack_core.camera import Picture, PinholeCamera
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.calibration import known_cell
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.camera import from_camera_info, from_image
from pack_core.ros.messages.conversions import from_stamp, to_stamp
from pack_core.ros.messages.palletizing import from_expected_box, to_detection, to_sighting
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_perception.boxes.board_corners import sight_board
from pack_perception.boxes.box_vision import BoxVision, IllustratedDetection, VisionConfig
from pack_perception.boxes.debug_images import DebugImages
from pack_perception.boxes.table_camera import TableCamera

FRAME_ID = "overhead_camera"
TOPICS = {
    "frame": contracts.VISION_FRAME,
    "roi": contracts.VISION_ROI,
    "mask": contracts.VISION_MASK,
    "overlay": contracts.VISION_OVERLAY,
}


class DebugPublisher:
    """Publishes each detection's pictures: photographs as JPEG, the mask without loss."""

    def __init__(self, node: CellNode) -> None:
        self._publishers = {name: node.advertise(contract) for name, contract in TOPICS.items()}

    def publish(self, time: float, images: DebugImages) -> None:
        """Publish the debug images of a picture taken at `time` [s]."""
        for name, publisher in self._publishers.items():
            publisher.publish(to_compressed(time, getattr(images, name)))


def to_compressed(time: float, image: Picture) -> CompressedImage:
    """Encode an RGB picture `(h, w, 3)` as JPEG, or a mask `(h, w)` as PNG."""
    is_mask = image.ndim == 2
    _, data = (
        cv2.imencode(".png", image)
        if is_mask
        else cv2.imencode(".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
    )
    message = CompressedImage(format="mono8; png compressed" if is_mask else "rgb8; jpeg compressed bgr8")
    message.header.stamp, message.header.frame_id = to_stamp(time), FRAME_ID
    message.data = array("B", data.tobytes())
    return message


class VisionNodeConfig(VisionConfig):
    """Parameters of the node `vision`."""

    pictures: str = Field("", description="folder for the debug images of every detection; empty: none")
    preset: str = Field("rigid", description="of config/presets/palletizing")
    calibration: str = Field("", description="calibration file of the cell; empty: none")


class BoxVisionNode(CellNode):
    """Detects the expected box in every picture that was taken since it was announced, or the board."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("vision", **kwargs)
        self._config = self.read_parameters(VisionNodeConfig)
        self._known = known_cell(self._config.preset, self._config.calibration)
        self._vision = BoxVision(self._config)
        self._camera: PinholeCamera | None = None
        self._table: TableCamera | None = None
        self._expected: ExpectedBox | None = None
        self._image: Image | None = None
        self._detection = self.advertise(contracts.BOX_DETECTION)
        self._sighting = self.advertise(contracts.BOARD_SIGHTING)
        self._debug = DebugPublisher(self)
        self.listen(contracts.CAMERA_INFO, self._on_camera_info)
        self.listen(contracts.EXPECTED_BOX, self._on_expected_box)
        self.listen(contracts.IMAGE, self._on_image)
        self.watch(("sim", "fsm"))

    def _on_camera_info(self, message: CameraInfo) -> None:
        camera = self._known.camera(from_camera_info(message, self._known.cell.overhead_camera.X_WC))
        before = self._camera
        if before is None or (before.f, before.c, before.width) != (camera.f, camera.c, camera.width):
            self._camera, self._table = camera, TableCamera(self._known.cell, self._vision, camera)
        self._answer()

    def _on_expected_box(self, message: ExpectedBoxMsg) -> None:
        self._expected = from_expected_box(message)
        self._answer()

    def _on_image(self, message: Image) -> None:
        self._image = message
        self._answer()

    def _answer(self) -> None:
        """Detect in the last picture, once picture, intrinsics and expected box have come in any sequence."""
        message, camera, table, box = self._image, self._camera, self._table, self._expected
        if message is None or camera is None or table is None or box is None:
            return
        time = from_stamp(message.header.stamp)
        if time < box.time:
            return
        self._image = None
        if box.id == CALIBRATION_BOARD.name:
            self._sighting.publish(to_sighting(sight_board(from_image(message, camera), time)))
            return
        sighting = table.detect(from_image(message, camera), box, time)
        self._detection.publish(to_detection(sighting.detection))
        self._debug.publish(time, sighting.images)
        self._note(sighting.detection)
        self._write(sighting)

    def _note(self, detection: BoxDetection) -> None:
        self.health.values["last detection"] = f"{detection.box_id}: {detection.status.name}"
        if detection.status is not DetectionStatus.DETECTED:
            self.health.count("refused detection", f"box '{detection.box_id}': {detection.reason}")
            self.get_logger().warning(f"box '{detection.box_id}' refused: {detection.reason}")

    def _write(self, sighting: IllustratedDetection) -> None:
        if not self._config.pictures:
            return
        stem = f"{sighting.detection.time:010.3f}_{sighting.detection.box_id}".replace("/", "_")
        try:
            sighting.images.write(Path(self._config.pictures), stem)
        except OSError as error:
            folder = self._config.pictures
            self.health.faults["pictures"] = f"parameter pictures is '{folder}': {error.strerror}"


def main() -> int:
    """Entry point of `box_vision_node`."""
    return run_node(BoxVisionNode)
