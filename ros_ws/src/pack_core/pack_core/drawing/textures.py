"""What surfaces look like, sawn wood, cardboard and tags, and how a picture becomes a material of a model."""

from __future__ import annotations

import cv2
import mujoco
import numpy as np

from pack_core.camera import Picture

WOOD_SIZE = (256, 512)
WOOD_COLOUR = np.array([206.0, 172.0, 124.0])
"""Mean colour of the wood's picture, 0 to 255; its size is that before [pixel]."""
CARDBOARD_PIXELS = 256
"""Side of a face's picture."""
BROWNS = ((196, 154, 104), (184, 140, 92), (205, 166, 118), (176, 132, 88))
TAPES = ((214, 190, 146), (222, 204, 170))
"""Colours of cardboard and of the tape on it, one of which is drawn, 0 to 255."""
TAG_FAMILY = cv2.aruco.DICT_APRILTAG_36h11
TAG_MODULES = 8
"""Modules along the edge of a tag's black square."""
MODULE_PIXELS = 32
"""Pixels along the edge of a module."""
BLOCK_COLOUR = (199, 164, 116)
"""Of the faces without a tag, 0 to 255."""


def add_material(
    spec: mujoco.MjSpec, name: str, picture: Picture, *, specular: float, shininess: float
) -> None:
    """Add a material `name` of a picture `(height, width, 3)`.

    One of six faces in a column, `(6 n, n, 3)`, is put around a box: right, left, up, down, front and back,
    of which MuJoCo puts front on +z and back on -z of the box.
    """
    height, width, _ = picture.shape
    kind = mujoco.mjtTexture.mjTEXTURE_CUBE if height == 6 * width else mujoco.mjtTexture.mjTEXTURE_2D
    texture = spec.add_texture(name=name, type=kind, width=width, height=height, nchannel=3)
    texture.data = picture.tobytes()
    material = spec.add_material(name=name, specular=specular, shininess=shininess)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name


def wood_picture(rng: np.random.Generator) -> Picture:
    """A picture `(256, 512, 3)`, RGB, of wood whose grain runs along the width."""
    grain = cv2.GaussianBlur(rng.normal(0.0, 1.0, WOOD_SIZE), (0, 0), 40.0, sigmaY=1.5)
    fibre = cv2.GaussianBlur(rng.normal(0.0, 1.0, WOOD_SIZE), (0, 0), 12.0, sigmaY=0.6)
    tone = 22.0 * grain / grain.std() * 0.6 + 5.0 * fibre / fibre.std()
    wood = WOOD_COLOUR + tone[:, :, None] * np.array([1.0, 0.95, 0.8])
    return np.asarray(np.clip(wood, 0, 255), dtype=np.uint8)


def cardboard_faces(rng: np.random.Generator) -> Picture:
    """The six faces of a box as a column of pictures `(6 * CARDBOARD_PIXELS, CARDBOARD_PIXELS, 3)`.

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
    grain = cv2.GaussianBlur(
        rng.normal(0.0, 1.0, (CARDBOARD_PIXELS, CARDBOARD_PIXELS)), (0, 0), 3.0, sigmaY=0.8
    )
    noise = 14.0 * grain + rng.normal(0.0, 2.5, grain.shape)
    return np.asarray(np.clip(np.array(colour) + noise[:, :, None], 0, 255), dtype=np.uint8)


def _put_tape(face: Picture, colour: tuple[int, int, int]) -> None:
    """A strip of tape over the seam along the middle."""
    middle, half = CARDBOARD_PIXELS // 2, CARDBOARD_PIXELS // 12
    strip = face[middle - half : middle + half]
    strip[:] = (0.35 * strip + 0.65 * np.array(colour)).astype(np.uint8)
    face[middle - 1 : middle + 1] = (0.8 * face[middle - 1 : middle + 1]).astype(np.uint8)


def _put_label(face: Picture, rng: np.random.Generator) -> None:
    """A white label with a bar code."""
    x, y = rng.integers(CARDBOARD_PIXELS // 8, CARDBOARD_PIXELS // 2, 2)
    width, height = CARDBOARD_PIXELS // 3, CARDBOARD_PIXELS // 4
    face[y : y + height, x : x + width] = 238
    bars = np.repeat(rng.random(width // 3) < 0.5, 3)[: width - 12]
    code = face[y + 6 : y + height // 2, x + 6 : x + 6 + len(bars)]
    code[:, bars] = 30
    for row in range(y + height // 2 + 6, y + height - 6, 8):
        face[row : row + 3, x + 6 : x + 6 + int(rng.integers(width // 2, width - 12))] = 90


def _print_arrows(face: Picture, brown: tuple[int, int, int]) -> None:
    """Two arrows that say which side is up, in dark brown."""
    ink = tuple(int(0.4 * channel) for channel in brown)
    size = CARDBOARD_PIXELS
    for x in (size // 3, 2 * size // 3):
        tip = np.array([[x, size // 3], [x - size // 12, size // 2], [x + size // 12, size // 2]], np.int32)
        cv2.fillPoly(face, [tip], ink)
        cv2.rectangle(face, (x - size // 36, size // 2), (x + size // 36, 2 * size // 3), ink, -1)


def tag_face(number: int, tag_edge: float, face: tuple[float, float]) -> Picture:
    """The upper face of a block, `(height, width, 3)` RGB: the tag with its white margin, as large as it.

    Args:
        number: of the tag.
        tag_edge: of the black square [m].
        face: width and height of the face [m].
    """
    width, height = (round(TAG_MODULES * MODULE_PIXELS * edge / tag_edge) for edge in face)
    dictionary = cv2.aruco.getPredefinedDictionary(TAG_FAMILY)
    tag = cv2.aruco.generateImageMarker(dictionary, number, TAG_MODULES * MODULE_PIXELS)
    left, upper = (width - len(tag)) // 2, (height - len(tag)) // 2
    picture = np.full((height, width, 3), 255, dtype=np.uint8)
    picture[upper : upper + len(tag), left : left + len(tag)] = tag[..., None]
    return picture


def cube_faces(number: int, tag_edge: float, face: tuple[float, float]) -> Picture:
    """The six faces `(6 n, n, 3)` of a cube texture whose front face, a box's +z, carries the tag.

    A box stretches a square picture over each of its faces, so that of an oblong face is compressed before.
    """
    top = tag_face(number, tag_edge, face)
    if (pixels := max(top.shape[:2])) > min(top.shape[:2]):
        top = np.asarray(cv2.resize(top, (pixels, pixels), interpolation=cv2.INTER_NEAREST), dtype=np.uint8)
    side = np.empty_like(top)
    side[:] = BLOCK_COLOUR
    return np.concatenate([side, side, side, side, top, side])
