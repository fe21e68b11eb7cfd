"""Publishes what the simulated depth cameras measure."""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Self

import mujoco
import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import DepthFrame
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.camera import to_camera_info, to_depth_image
from pack_core.ros.messages.point_cloud import to_depth_cloud
from pack_core.ros.node import CellNode
from pack_core.rotations import Array
from pack_sim.camera_thread import CameraThread
from pack_sim.packing.depth_cameras import DepthCameraSystem
from pack_sim.packing.simulator import Simulator


@dataclass(frozen=True)
class DepthSnapshot:
    """Where everything was at a moment.

    Attributes:
        time: simulated time [s].
        model: the physics' model, which is never changed.
        qpos: its generalised positions `(nq,)`.
    """

    time: float
    model: mujoco.MjModel
    qpos: Array


class SnapshotDepthCameras:
    """Casts the rays of the depth cameras into snapshots, in whichever thread asks for it.

    Args:
        system: the cameras.
    """

    def __init__(self, system: DepthCameraSystem) -> None:
        self._system = system
        self._model: mujoco.MjModel | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """There is nothing to close."""

    def picture(self, snapshot: DepthSnapshot) -> DepthFrame:
        """The frame that is exposed at the moment of the snapshot."""
        if snapshot.model is not self._model:
            self._model, self._data = snapshot.model, mujoco.MjData(snapshot.model)
        self._data.qpos[:] = snapshot.qpos
        mujoco.mj_kinematics(snapshot.model, self._data)
        return self._system.capture(snapshot.model, self._data, snapshot.time)


class DepthPublisher:
    """Exposes the depth cameras at their rate, and publishes each frame when its latency has passed.

    Rays are cast in a thread of their own. A frame that is due while the last one is still being made is left
    out and counted on /diagnostics: on a machine that is too slow the cameras have a lower rate, and the
    physics goes on.

    Args:
        node: that publishes.
        cell: whose cameras they are.
    """

    def __init__(self, node: CellNode, cell: PackingCell) -> None:
        self._node, self._described = node, cell.depth
        self._cameras, self._names = cell.depth.cameras(), cell.depth.names
        self._images, self._infos, self._clouds = (
            [node.advertise(contract) for contract in topics[: len(self._names)]]
            for topics in (contracts.DEPTH_IMAGES, contracts.DEPTH_INFOS, contracts.DEPTH_POINTS)
        )
        self._thread: CameraThread[DepthSnapshot, DepthFrame] | None = None
        self._left_out = 0

    def open(self, seed: int, time: float) -> None:
        """Begin anew with other errors, those of a seed, at `time` [s]."""
        self.close()
        self._node.health.faults.pop("depth cameras", None)
        self._system = DepthCameraSystem(self._described, np.random.default_rng([seed, 2]))
        for info, camera, frame in zip(self._infos, self._cameras, self._names, strict=True):
            info.publish(to_camera_info(time, camera, frame))
        deliver = self._system.deliver
        self._thread = CameraThread(
            SnapshotDepthCameras(self._system), lambda _, frame: deliver(frame), self._report,
            niceness=0,  # the arm pushes by what is seen
        )  # fmt: skip

    def step(self, simulator: Simulator) -> None:
        """Expose if it is time, and publish what is due."""
        time = simulator.time
        thread = self._thread  # a service's thread may take it away meanwhile
        if thread is not None and self._system.is_due(time):
            snapshot = DepthSnapshot(time, simulator.model, np.array(simulator.data.qpos))
            self._left_out += not thread.expose(time, snapshot)
            self._node.health.values["depth frames left out"] = str(self._left_out)
        for frame in self._system.due(time):
            for publisher, image, name in zip(self._images, frame.images, self._names, strict=True):
                publisher.publish(to_depth_image(frame.time, image, name))
            self._publish_points(frame)

    def _publish_points(self, frame: DepthFrame) -> None:
        """Publish the points of a frame where somebody listens, as no node of the cell does."""
        for publisher, image, camera, name in zip(
            self._clouds, frame.images, self._cameras, self._names, strict=True
        ):
            if publisher.get_subscription_count():
                publisher.publish(to_depth_cloud(frame.time, image, camera, name))

    def wait(self) -> None:
        """Wait until the images that were exposed last are made."""
        thread = self._thread  # a service's thread may take it away meanwhile
        if thread is not None:
            thread.wait()

    def close(self) -> None:
        """Expose no more."""
        if self._thread is not None:
            self._thread.close()
            self._thread = None

    def _report(self, error: str) -> None:
        self._node.health.faults["depth cameras"] = error
        self._node.get_logger().error(error)
