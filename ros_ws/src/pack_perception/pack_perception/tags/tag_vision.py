"""Poses of blocks from the AprilTags on top of them.

Every tag lies in a known plane, its block's upper face, so a corner's pixel is a point of that plane and
a block's pose is that of a square fitted to four points. A free pose from one small tag would be
millimetres off, and tilted.
"""

from __future__ import annotations

from collections.abc import Mapping

import cv2
import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat

from pack_core.blocks.block_sighting import BlockSighting, unknown_id
from pack_core.blocks.cell import Block
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBES, BlockSizes
from pack_core.camera import PinholeCamera
from pack_core.config import Config
from pack_core.drawing.textures import TAG_FAMILY
from pack_core.rotations import Array

CORNERS = np.array([[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]])
"""Of a tag in its own frame, x right and y up, in the order in which the detector names them."""


class TagVisionConfig(Config):
    """Parameters of tag perception."""

    refinement_window: int = Field(default=5, ge=1, description="half width for sub-pixel corners [pixel]")
    refinement_steps: int = Field(default=50, ge=1, description="at most, for sub-pixel corners")
    max_edge_error: PositiveFloat = Field(
        default=0.002, description="mean edge of a tag against the true one, else it is no block's top [m]"
    )
    max_residual: PositiveFloat = Field(
        default=0.001, description="rms of the corners against the fitted square [m]"
    )


class TagVision:
    """Finds blocks in pictures.

    Args:
        config: parameters.
        block: size of a block and its tag, also of blocks that nobody knows.
        tags: the number of every block's tag, by the block's id.
        sizes: of the blocks that are not cubes, by id.
    """

    def __init__(
        self, config: TagVisionConfig, block: Block, tags: Mapping[str, int], sizes: BlockSizes = CUBES
    ) -> None:
        self._config, self._block, self._sizes = config, block, sizes
        self._ids = {number: name for name, number in tags.items()}
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        parameters.cornerRefinementWinSize = config.refinement_window
        parameters.cornerRefinementMaxIterations = config.refinement_steps
        self._detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(TAG_FAMILY), parameters)

    def find(self, picture: npt.NDArray[np.uint8], camera: PinholeCamera, time: float) -> BlockSighting:
        """Blocks in a picture.

        Args:
            picture: `(height, width, 3)` RGB or `(height, width)` grey.
            camera: that took it.
            time: when [s].
        """
        grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY) if picture.ndim == 3 else picture
        squares, numbers, _ = self._detector.detectMarkers(grey)
        seen: dict[str, list[PlanarPose]] = {name: [] for name in self._ids.values()}
        unknown: set[int] = set()
        for pixels, number in zip(squares, [] if numbers is None else numbers.ravel(), strict=True):
            name = self._ids.get(int(number), unknown_id(int(number)))
            if int(number) not in self._ids:
                unknown.add(int(number))
                seen.setdefault(name, [])
            size = self._sizes.get(name, self._block.cube)
            corners_W = camera.at_height(pixels.reshape(4, 2), size.z)
            if (pose := self._fit(corners_W, self._block.tag_edge_of(size))) is not None:
                seen[name].append(pose)
        return BlockSighting(
            time, {name: poses[0] for name, poses in seen.items() if len(poses) == 1},
            missing=tuple(name for name in self._ids.values() if not seen[name]),
            doubled=tuple(name for name, poses in seen.items() if len(poses) > 1),
            unknown=tuple(sorted(unknown)),
        )  # fmt: skip

    def _fit(self, corners_W: Array, tag_edge: float) -> PlanarPose | None:
        """Pose of the square of the tag's edge [m] that fits corners `(4, 3)` best, if they are of one."""
        p, square = corners_W[:, :2], CORNERS * tag_edge
        centre = p.mean(axis=0)
        q = p - centre
        yaw = float(np.arctan2(np.sum(_cross(square, q)), np.sum(square * q)))
        c, s = np.cos(yaw), np.sin(yaw)
        residual = np.sqrt(np.mean(np.sum((q - square @ np.array([[c, s], [-s, c]])) ** 2, axis=1)))
        edge = np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1).mean()
        if residual > self._config.max_residual or abs(edge - tag_edge) > self._config.max_edge_error:
            return None
        return PlanarPose(float(centre[0]), float(centre[1]), yaw)


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
