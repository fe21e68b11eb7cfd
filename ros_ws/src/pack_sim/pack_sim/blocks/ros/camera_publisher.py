"""The overhead camera's topics."""

from __future__ import annotations

from collections.abc import Mapping

from pack_core.blocks.cell import BlocksCell
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.messages.camera import to_camera_info, to_image
from pack_core.ros.node import CellNode
from pack_core.rotations import Array
from pack_sim.blocks.overhead_camera import OverheadCamera, Picture
from pack_sim.camera_thread import CameraThread

FRAME = "overhead_camera"


class CameraPublisher:
    """Publishes each picture with the intrinsics of the camera.

    Args:
        node: that publishes.
        cell: whose camera it is.
        timestep: of the physics [s].
        shadows: draw them.
    """

    def __init__(self, node: CellNode, cell: BlocksCell, timestep: float, *, shadows: bool) -> None:
        self._node, self._cell = node, cell
        self._timestep, self._shadows = timestep, shadows
        self._image = node.advertise(contracts.IMAGE)
        self._info = node.advertise(contracts.CAMERA_INFO)
        self._thread: CameraThread[Array] | None = None
        self._error = ""

    def open(self, tags: Mapping[str, int]) -> None:
        """Look at a table with these blocks; the number of each one's tag by its id."""
        self.close()
        camera = OverheadCamera(self._cell, tags, self._timestep, shadows=self._shadows)
        self._thread = CameraThread(camera, self._publish, self._report)

    def expose(self, time: float, snapshot: Array) -> str:
        """Have a picture taken; why there is none, empty otherwise."""
        if self._thread is not None and self._thread.expose(time, snapshot):
            return ""
        return self._error or "the last picture is still being made"

    def close(self) -> None:
        """Take no more pictures."""
        if self._thread is not None:
            self._thread.close()
            self._thread = None

    def _publish(self, time: float, picture: Picture) -> None:
        self._info.publish(to_camera_info(time, self._cell.camera.pinhole, FRAME))
        self._image.publish(to_image(time, picture, FRAME))

    def _report(self, error: str) -> None:
        self._error = self._node.health.faults["camera"] = error
        self._node.get_logger().error(error)
