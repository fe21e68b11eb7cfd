"""The overhead camera's topics."""

from __future__ import annotations

from pack_core.palletizing.view import Picture
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.camera import to_camera_info, to_image
from pack_core.ros.node import CellNode
from pack_sim.camera_thread import CameraThread
from pack_sim.palletizing.overhead_camera import PalletCameraConfig, camera_of
from pack_sim.palletizing.simulator import PalletSimulator
from pack_sim.palletizing.snapshot import Snapshot

FRAME = "overhead_camera"


class PalletCameraPublisher:
    """Publishes each picture with the intrinsics of the camera.

    Args:
        node: the node that publishes.
        simulator: the cell that the camera sees; intrinsics are published as the data sheet has them.
        config: size of the pictures.
    """

    def __init__(self, node: CellNode, simulator: PalletSimulator, config: PalletCameraConfig) -> None:
        overhead = simulator.open_camera(config)
        self._node, self._camera = node, camera_of(simulator.nominal, config)
        self._image = node.advertise(contracts.IMAGE)
        self._info = node.advertise(contracts.CAMERA_INFO)
        self._thread = CameraThread(overhead, self._publish, self._report)

    def expose(self, snapshot: Snapshot) -> bool:
        """Start to draw a picture; False while the last one is still being drawn."""
        return self._thread.expose(snapshot.time, snapshot)

    def close(self) -> None:
        """Stop the threads that draw and publish pictures."""
        self._thread.close()

    def _publish(self, time: float, picture: Picture) -> None:
        self._info.publish(to_camera_info(time, self._camera, FRAME))
        self._image.publish(to_image(time, picture, FRAME))

    def _report(self, error: str) -> None:
        self._node.health.faults["camera"] = error
        self._node.get_logger().error(error)
