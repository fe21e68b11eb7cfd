"""Tag perception as a ROS 2 node: pictures in, poses of the blocks out."""

from __future__ import annotations

from typing import Any

from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String

from pack_core.blocks.cell import blocks_cell
from pack_core.camera import PinholeCamera
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.messages.blocks import from_tags, to_sighting
from pack_core.ros.messages.camera import from_camera_info, from_image
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_perception.tags.tag_vision import TagVision, TagVisionConfig


class TagPerceptionNode(CellNode):
    """Looks for the blocks' tags in every picture."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("tags", **kwargs)
        self._config = self.read_parameters(TagVisionConfig)
        self._cell = blocks_cell()
        self._vision: TagVision | None = None
        self._camera: PinholeCamera | None = None
        self._sightings = self.advertise(contracts.BLOCK_POSES)
        self.listen(contracts.TAGS, self._on_tags)
        self.listen(contracts.CAMERA_INFO, self._on_camera)
        self.listen(contracts.IMAGE, self._on_image)
        self.watch(("sim",))

    def _on_tags(self, message: String) -> None:
        self._vision = TagVision(self._config, self._cell.block, *from_tags(message))

    def _on_camera(self, message: CameraInfo) -> None:
        self._camera = from_camera_info(message, self._cell.camera.pinhole.X_WC)

    def _on_image(self, message: Image) -> None:
        if self._vision is None or self._camera is None:
            self.health.count("unused picture", "tags or intrinsics are not known yet")
            return
        picture = from_image(message, self._camera)
        sighting = self._vision.find(picture, self._camera, from_stamp(message.header.stamp))
        self._sightings.publish(to_sighting(sighting))
        self.health.values["missing"] = ", ".join(sighting.missing) or "none"
        self.health.values["doubled"] = ", ".join(sighting.doubled) or "none"


def main() -> int:
    """Entry point of `tag_perception_node`."""
    return run_node(TagPerceptionNode)
