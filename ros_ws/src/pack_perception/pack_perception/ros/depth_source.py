"""Frames of the depth cameras, and what perception makes of them."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String

from pack_core.camera import PinholeCamera
from pack_core.errors import MessageError
from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import DepthFrame, FramePairing
from pack_core.packing.depth_calibration import load_depth_calibration
from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SeenObjects
from pack_core.ros.clock import StampCheck
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.camera import from_camera_info, from_depth_image
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.node import CellNode
from pack_core.ros.params import read_only
from pack_core.ros.stream import Stream
from pack_core.rotations import Array
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.mocap.physics_estimator import Correction
from pack_perception.perception_config import PerceptionConfig
from pack_perception.ros.frame_sources import Frame

COVERED = 0.1
"""Share of its pixels that a depth camera at least measures when nothing covers it; it is 0.8."""
INTRINSICS = 0.5
"""Largest difference between a depth camera's intrinsics and those that are described [pixel]."""


class DepthSource:
    """Images of the depth cameras; tells others what is known of the objects, as described or as seen.

    Args:
        node: who looks.
        cell: the cell's physical facts.
        config: parameters.
    """

    told = contracts.SIM_DESCRIPTION

    def __init__(self, node: CellNode, cell: PackingCell, config: PerceptionConfig) -> None:
        self._node, self._cell, self._config = node, cell, config
        self._stamps = StampCheck(node)
        told = node.declare_parameter("calibration", "", read_only("file of pack calibrate packing")).value
        described = cell.depth
        self._calibrated = load_depth_calibration(Path(told)).applied(described) if told else None
        self._cameras, self._names = self._calibrated or described.cameras(), described.names
        self._images = contracts.DEPTH_IMAGES[: len(self._names)]
        self._infos = contracts.DEPTH_INFOS[: len(self._names)]
        self._measured: dict[int, float] = {}
        self._has_info = [False] * len(self._cameras)
        self.streams = tuple(Stream(node, contract) for contract in self._images)
        self._taken: list[tuple[float, int, Array]] = []
        self._pairing = FramePairing(len(self._cameras))
        self._described: Scene | None = None
        self._looked = float("nan")
        self._description, self._seen = (
            node.advertise(contracts.DESCRIPTION),
            node.advertise(contracts.SEEN_OBJECTS),
        )
        for i, contract in enumerate(self._infos):
            node.listen(contract, partial(self._on_info, i))

    def begin(self, scene: Scene) -> HandOverEstimator:
        """The estimate of a scene that was told."""
        self._pairing = FramePairing(len(self._cameras))
        estimator = DepthEstimator(scene, self._cell, self._config, self._calibrated)
        self._describe(estimator)
        return estimator

    def take(self) -> list[Frame]:
        """The frames that have come, oldest first."""
        self._taken = []
        for i, (stream, contract) in enumerate(zip(self.streams, self._images, strict=True)):
            for message in stream.take_all():
                self._node.guard(contract, partial(self._add, i), message)
        self._taken.sort(key=lambda item: item[:2])
        frames = [self._pairing.add(camera, time, image) for time, camera, image in self._taken]
        self._note()
        return [frame for frame in frames if frame is not None]

    def correct(self, estimator: HandOverEstimator, frame: Frame) -> Correction:
        """Correct an estimate by images, and tell others of a scene that was seen anew."""
        assert isinstance(frame, DepthFrame)
        assert isinstance(estimator, DepthEstimator)
        correction = estimator.see(frame)
        self._describe(estimator)
        self._tell("registration", self._moved(estimator))
        return correction

    def unknown(self, estimator: HandOverEstimator | None) -> str:
        """What has to be known before a goal, in words; empty: nothing."""
        if not isinstance(estimator, DepthEstimator):
            return f"no {self.told.name} yet: is sim up?"
        if moved := self._moved(estimator):
            return moved
        if estimator.knows_objects:
            return ""
        missing = [c.name for c, has in zip(self._infos, self._has_info, strict=True) if not has]
        if missing:
            return f"no {', '.join(missing)} yet"
        why = f": {estimator.hindrance}" if estimator.hindrance else ""
        return f"no look into the container yet{why}"

    def _moved(self, estimator: DepthEstimator) -> str:
        """Cameras that hang elsewhere than described, in words."""
        off = [f"{self._names[i]} is off by {words}" for i, words in estimator.misplaced.items()]
        cure = "calibrate the cell (pack calibrate packing), or hang it as config/cells/packing.yaml says"
        return f"{', '.join(off)}: {cure}" if off else ""

    def _describe(self, estimator: DepthEstimator) -> None:
        if estimator.knows_objects and estimator.scene is not self._described:
            self._described = estimator.scene
            self._description.publish(String(data=estimator.scene.to_yaml()))
        if np.isfinite(estimator.looked) and estimator.looked != self._looked:
            self._looked = estimator.looked
            seen = SeenObjects(time=estimator.looked, objects=estimator.deviations)
            self._seen.publish(String(data=seen.to_yaml()))

    def _on_info(self, camera: int, message: CameraInfo) -> None:
        described = self._cameras[camera]
        given = from_camera_info(message, described.X_WC)
        if not _are_alike(given, described):
            raise MessageError(
                f"{self._names[camera]} has {_intrinsics(given)}, described is {_intrinsics(described)}; "
                "change `depth` in config/cells/packing.yaml, or the camera"
            )
        self._has_info[camera] = True

    def _add(self, camera: int, message: Image) -> None:
        time = from_stamp(message.header.stamp)
        self._stamps.check(time)
        if not self._has_info[camera]:
            self._node.health.count("unused image", f"no intrinsics of {self._names[camera]} yet")
            return
        image = from_depth_image(message, self._cameras[camera])
        self._measured[camera] = np.count_nonzero(image) / image.size
        self._taken.append((time, camera, image))

    def _note(self) -> None:
        """Report cameras that are not waited for, and those that see next to nothing."""
        for camera, share in self._measured.items():
            seen = f"{self._names[camera]} measures {100 * share:.0f} % of its pixels: is its lens covered?"
            self._tell(self._names[camera], seen if share < COVERED else "")
        silent = ", ".join(self._names[i] for i in self._pairing.silent)
        self._tell("cameras", silent and f"{silent} brings no images; the others go on without it")

    def _tell(self, name: str, fault: str) -> None:
        """Report a fault, or, where there is none, that it is over; one that lasts is there all the time."""
        if fault:
            self._node.health.faults[name] = fault
        else:
            self._node.health.faults.pop(name, None)


def _are_alike(one: PinholeCamera, other: PinholeCamera) -> bool:
    sizes = (one.width, one.height) == (other.width, other.height)
    return sizes and bool(np.allclose((one.f, *one.c), (other.f, *other.c), rtol=0.0, atol=INTRINSICS))


def _intrinsics(camera: PinholeCamera) -> str:
    u, v = camera.c
    return f"{camera.width} x {camera.height} pixels, f {camera.f:.1f}, middle ({u:.1f}, {v:.1f})"
