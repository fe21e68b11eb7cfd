"""Publishes the pictures of a simulated overhead camera."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Generic, TypeVar

from pack_core.camera import Picture, PinholeCamera
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.camera import to_camera_info, to_image
from pack_core.ros.node import CellNode
from pack_sim.camera_thread import CameraThread, SnapshotCamera

FRAME = "overhead_camera"
Snapshot = TypeVar("Snapshot")


class CameraPublisher(Generic[Snapshot]):
    """Has pictures drawn in a thread of their own, and publishes each with the intrinsics of the camera.

    Args:
        node: that publishes.
        image: topic of the pictures.
        info: topic of the intrinsics.
        intrinsics: as they are published.
    """

    def __init__(self, node: CellNode, image: Contract, info: Contract, intrinsics: PinholeCamera) -> None:
        self._node, self._intrinsics = node, intrinsics
        self._image, self._info = node.advertise(image), node.advertise(info)
        self._thread: CameraThread[Snapshot, Picture] | None = None
        self._error = ""

    def open(self, camera: AbstractContextManager[SnapshotCamera[Snapshot, Picture]]) -> None:
        """Have this camera draw, in the place of the one before."""
        self.close()
        self._report("")
        self._thread = CameraThread(camera, self._publish, self._report)

    def expose(self, time: float, snapshot: Snapshot) -> str:
        """Have a picture drawn that is exposed at `time` [s]; says why there is none, empty otherwise."""
        thread = self._thread  # a service's thread may take it away meanwhile
        if thread is not None and thread.expose(time, snapshot):
            return ""
        return self._error or "the last picture is still being made"

    def wait(self) -> None:
        """Wait until the picture that was asked for last is published."""
        thread = self._thread  # a service's thread may take it away meanwhile
        if thread is not None:
            thread.wait()

    def close(self) -> None:
        """Draw no more pictures."""
        if self._thread is not None:
            self._thread.close()
            self._thread = None

    def _publish(self, time: float, picture: Picture) -> None:
        self._info.publish(to_camera_info(time, self._intrinsics, FRAME))
        self._image.publish(to_image(time, picture, FRAME))

    def _report(self, error: str) -> None:
        """Tell why there are no pictures; empty: there are."""
        self._error = error
        if error:
            self._node.health.faults["camera"] = error
            self._node.get_logger().error(error)
        else:
            self._node.health.faults.pop("camera", None)
