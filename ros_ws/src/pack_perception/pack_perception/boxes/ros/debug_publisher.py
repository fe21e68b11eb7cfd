"""The debug images of box vision as topics."""

from __future__ import annotations

from array import array

import cv2
from sensor_msgs.msg import CompressedImage

from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.conversions import to_stamp
from pack_core.ros.node import CellNode
from pack_perception.boxes.debug_images import DebugImages
from pack_perception.boxes.segmentation import Picture

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
