"""The face of a block's tag, drawn from OpenCV's dictionary."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

FAMILY = cv2.aruco.DICT_APRILTAG_36h11
TAGS = 587
"""Tags in the family."""
MODULES = 8
"""Modules along the edge of a tag's black square."""
MODULE_PIXELS = 32
WOOD = (199, 164, 116)

Picture = npt.NDArray[np.uint8]


def tag_face(number: int, tag_edge: float, block_edge: float) -> Picture:
    """The upper face of a block, `(n, n, 3)` RGB: the tag with its white margin, as large as the face.

    Args:
        number: of the tag.
        tag_edge: of the black square [m].
        block_edge: of the face [m].
    """
    size = round(MODULES * MODULE_PIXELS * block_edge / tag_edge)
    dictionary = cv2.aruco.getPredefinedDictionary(FAMILY)
    tag = cv2.aruco.generateImageMarker(dictionary, number, MODULES * MODULE_PIXELS)
    first = (size - len(tag)) // 2
    face = np.full((size, size, 3), 255, dtype=np.uint8)
    face[first : first + len(tag), first : first + len(tag)] = tag[..., None]
    return face


def cube_faces(number: int, tag_edge: float, block_edge: float) -> Picture:
    """The six faces `(6 n, n, 3)` of a cube texture whose front face, a box's +z, carries the tag."""
    top = tag_face(number, tag_edge, block_edge)
    side = np.empty_like(top)
    side[:] = WOOD
    return np.concatenate([side, side, side, side, top, side])
