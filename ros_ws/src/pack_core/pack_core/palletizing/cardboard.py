"""Pictures of cardboard: fibres, a strip of tape, a label, printing."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]
FACE_PIXELS = 256
"""Side of a face's picture."""
BROWNS = ((196, 154, 104), (184, 140, 92), (205, 166, 118), (176, 132, 88))
TAPES = ((214, 190, 146), (222, 204, 170))


def cardboard_faces(rng: np.random.Generator) -> Picture:
    """The six faces of a box as a column of pictures `(6 * FACE_PIXELS, FACE_PIXELS, 3)`.

    Order: right, left, up, down, front, back, of which MuJoCo puts front on +z and back on -z of a box.
    """
    brown = BROWNS[rng.integers(len(BROWNS))]
    faces = [_paper(brown, rng) for _ in range(6)]
    for face in (faces[4], faces[5]):
        _put_tape(face, TAPES[rng.integers(len(TAPES))])
    _put_label(faces[int(rng.integers(4))], rng)
    _print_arrows(faces[int(rng.integers(4))], brown)
    return np.concatenate(faces)


def _paper(colour: tuple[int, int, int], rng: np.random.Generator) -> Picture:
    grain = cv2.GaussianBlur(rng.normal(0.0, 1.0, (FACE_PIXELS, FACE_PIXELS)), (0, 0), 3.0, sigmaY=0.8)
    noise = 14.0 * grain + rng.normal(0.0, 2.5, grain.shape)
    return np.asarray(np.clip(np.array(colour) + noise[:, :, None], 0, 255), dtype=np.uint8)


def _put_tape(face: Picture, colour: tuple[int, int, int]) -> None:
    """A strip of tape over the seam along the middle."""
    middle, half = FACE_PIXELS // 2, FACE_PIXELS // 12
    strip = face[middle - half : middle + half]
    strip[:] = (0.35 * strip + 0.65 * np.array(colour)).astype(np.uint8)
    face[middle - 1 : middle + 1] = (0.8 * face[middle - 1 : middle + 1]).astype(np.uint8)


def _put_label(face: Picture, rng: np.random.Generator) -> None:
    """A white label with a bar code."""
    x, y = rng.integers(FACE_PIXELS // 8, FACE_PIXELS // 2, 2)
    width, height = FACE_PIXELS // 3, FACE_PIXELS // 4
    face[y : y + height, x : x + width] = 238
    bars = np.repeat(rng.random(width // 3) < 0.5, 3)[: width - 12]
    code = face[y + 6 : y + height // 2, x + 6 : x + 6 + len(bars)]
    code[:, bars] = 30
    for row in range(y + height // 2 + 6, y + height - 6, 8):
        face[row : row + 3, x + 6 : x + 6 + int(rng.integers(width // 2, width - 12))] = 90


def _print_arrows(face: Picture, brown: tuple[int, int, int]) -> None:
    """Two arrows that say which side is up, in dark brown."""
    ink = tuple(int(0.4 * channel) for channel in brown)
    size = FACE_PIXELS
    for x in (size // 3, 2 * size // 3):
        tip = np.array([[x, size // 3], [x - size // 12, size // 2], [x + size // 12, size // 2]], np.int32)
        cv2.fillPoly(face, [tip], ink)
        cv2.rectangle(face, (x - size // 36, size // 2), (x + size // 36, 2 * size // 3), ink, -1)
