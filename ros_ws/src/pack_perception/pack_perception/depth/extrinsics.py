"""Where depth cameras hang and the container stands, as images in which the container is seen say.

Images tell that a camera and the container are elsewhere than described, but not which of them is. Cameras
that were calibrated to the arm are believed; then it is the container. Else the container is believed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.packing.depth import DepthFrame, points_of
from pack_core.packing.scene import Container
from pack_core.rotations import Array
from pack_perception.depth.registration import register
from pack_perception.perception_config import DepthConfig

BELOW_TABLE = -0.01
"""Lowest height of points that noise has put there [m]; what is lower is no measurement."""
AGREEMENT = 0.0015
"""Calibrated cameras that see the container farther apart were knocked since [m]: ten times their error."""


class Extrinsics:
    """Poses of cameras and container in the world, corrected by each frame that is registered.

    Args:
        described: the cameras as the cell, or a calibration, describes them.
        is_calibrated: whether that is a calibration.
        container: as the scene describes it.
        config: parameters.

    Attributes:
        cameras: where they hang.
        container: where it stands.
        misplaced: how far off each camera is that hangs elsewhere than can be corrected, in words, by its
            place in the list.
    """

    def __init__(
        self, described: Sequence[PinholeCamera], *, is_calibrated: bool, container: Container,
        config: DepthConfig,
    ) -> None:  # fmt: skip
        self._described, self._is_calibrated, self._config = [*described], is_calibrated, config
        self.cameras, self.misplaced = [*described], dict[int, str]()
        self._told = self.container = container

    def expect(self, container: Container) -> None:
        """Take up the container of a scene; another one than before stands where it is described."""
        if container not in (self._told, self.container):
            self._told = self.container = container

    def points(self, frame: DepthFrame, every: int = 1) -> Array:
        """Points `(n, 3)` [m] of a frame from the table upwards, of one pixel in `every` each way."""
        pairs = zip(self.cameras, frame.images, strict=True)
        points = np.concatenate([points_of(camera, image, every) for camera, image in pairs])
        return np.asarray(points[points[:, 2] > BELOW_TABLE])

    def register(self, frame: DepthFrame) -> None:
        """Compare cameras and container, and note cameras that have moved."""
        config = self._config
        self.misplaced, shifts = {}, dict[int, Array]()
        for i, (camera, image) in enumerate(zip(self._described, frame.images, strict=True)):
            points = points_of(camera, image, config.every)
            found = register(points, camera.X_WC.p, self._told, config.registration)
            if found is None:  # too little to see: it stays where it was
                continue
            if not found.is_within(config.registration):
                self.misplaced[i] = found.in_words()
            elif self._is_calibrated:
                shifts[i] = found.shift
            else:
                self.cameras[i] = found.applied_to(camera)
        if shifts:
            self._shift_container(shifts)

    def _shift_container(self, shifts: dict[int, Array]) -> None:
        """Put the container where calibrated cameras see it, by how far each sees it off `(3,)` [m]."""
        seen = np.array(list(shifts.values()))
        apart = float(np.linalg.norm(np.ptp(seen, axis=0)))
        if apart > AGREEMENT:  # nobody can say which of them it is
            self.misplaced |= dict.fromkeys(shifts, f"{1e3 * apart:.0f} mm between the cameras")
            return
        x, y = self._told.centre - seen.mean(axis=0)[:2]
        self.container = self._told.model_copy(update={"centre": (float(x), float(y))})
