"""The calibration board, a ChArUco pattern on a plate with a bare end for the gripper; and how it is seen."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from pack_core.palletizing.boxes import BoxBody
from pack_core.rotations import Array

FAMILY = cv2.aruco.DICT_5X5_100
BOARD_PIXELS = 2100
"""Side of the face's picture, which is square, whatever the face's sides are. With this number squares have
whole numbers of pixels, 140 by 200."""


@dataclass(frozen=True)
class CalibrationBoard:
    """A stiff plate; its frame is that of a box of its size: origin in the middle, x along it, z up.

    Attributes:
        name: as a box in the cell.
        size: of the plate [m].
        mass: [kg].
        squares: of the pattern, along x and y.
        square: side of a square [m].
        marker: side of a marker in a square [m].
        handle: bare length at the end of -x, where the gripper's pad holds the plate [m].
    """

    name: str = "calibration board"
    size: tuple[float, float, float] = (0.60, 0.42, 0.01)
    mass: float = 2.5
    squares: tuple[int, int] = (11, 10)
    square: float = 0.04
    marker: float = 0.03
    handle: float = 0.14

    @property
    def body(self) -> BoxBody:
        """The plate as a body of the cell."""
        return BoxBody(self.name, self.size, self.mass)

    @property
    def pattern(self) -> cv2.aruco.CharucoBoard:
        """The pattern as OpenCV's detectors take it."""
        dictionary = cv2.aruco.getPredefinedDictionary(FAMILY)
        return cv2.aruco.CharucoBoard(self.squares, self.square, self.marker, dictionary)

    @property
    def first_corner(self) -> Array:
        """Where the pattern begins, the corner at least x and greatest y, in the plate's frame `(2,)` [m]."""
        x = -0.5 * self.size[0] + self.handle
        return np.array([x, 0.5 * self.squares[1] * self.square])

    @property
    def p_handle(self) -> Array:
        """Middle of the bare end's upper face in the plate's frame `(3,)` [m]."""
        return np.array([0.5 * (self.handle - self.size[0]), 0.0, 0.5 * self.size[2]])

    def corners(self) -> Array:
        """The inner corners of the pattern by their number, in the plate's frame `(n, 3)` [m]."""
        # OpenCV has the pattern's origin at its upper left corner, x to the right and y down.
        found = np.asarray(self.pattern.getChessboardCorners(), dtype=float)
        x, y = self.first_corner
        return np.column_stack([x + found[:, 0], y - found[:, 1], np.full(len(found), 0.5 * self.size[2])])


CALIBRATION_BOARD = CalibrationBoard()
"""The board that belongs to the cell."""


def board_face(board: CalibrationBoard) -> npt.NDArray[np.uint8]:
    """The upper face `(BOARD_PIXELS, BOARD_PIXELS, 3)`.

    As a flat texture it is on the lower face, too, and its grey margin on the sides. A cube texture would
    have six faces of this size: 220 MB of memory.
    """
    top = np.full((BOARD_PIXELS, BOARD_PIXELS, 3), 150, dtype=np.uint8)
    scale = BOARD_PIXELS / np.array(board.size[:2])  # pixels a metre, along x and along y
    extent = np.array(board.squares) * board.square
    picture = board.pattern.generateImage((1540, 1400), None, 0, 1)
    width, height = np.round(extent * scale).astype(int)
    x, y = board.first_corner
    left, upper = round((x + 0.5 * board.size[0]) * scale[0]), round((0.5 * board.size[1] - y) * scale[1])
    picture = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    top[upper : upper + height, left : left + width] = picture[..., None]
    return top


@dataclass(frozen=True)
class BoardSighting:
    """Corners of the board's pattern in one picture.

    Attributes:
        time: when the picture was taken [s].
        width: of the picture [pixel].
        ids: numbers of the corners that were seen `(n,)`; none where no board was found.
        pixels: where they were seen, u and v `(n, 2)` [pixel].
    """

    time: float
    width: int
    ids: Array
    pixels: Array

    def scaled(self, width: int) -> BoardSighting:
        """The same in pictures of another width [pixel]."""
        if width == self.width:
            return self
        # The left edge of both pictures is at -0.5, half a pixel before the first pixel's centre.
        return replace(self, width=width, pixels=(self.pixels + 0.5) * np.float64(width / self.width) - 0.5)
