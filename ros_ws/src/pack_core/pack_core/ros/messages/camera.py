"""Pictures and the camera that took them, as messages."""

from __future__ import annotations

from array import array

import numpy as np
import numpy.typing as npt
from sensor_msgs.msg import CameraInfo, Image

from pack_core.camera import PinholeCamera
from pack_core.errors import MessageError
from pack_core.ros.messages.conversions import finite, to_stamp
from pack_core.rotations import Array, Pose


def to_image(time: float, picture: npt.NDArray[np.uint8], frame: str) -> Image:
    """A message of an RGB picture `(height, width, 3)` that was exposed at `time` [s]."""
    height, width, _ = picture.shape
    message = Image(height=height, width=width, encoding="rgb8", step=3 * width)
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    data = array("B")  # the only type that rclpy takes without checking every byte
    data.frombytes(np.ascontiguousarray(picture).data.cast("B"))
    message.data = data
    return message


def from_image(message: Image, camera: PinholeCamera) -> npt.NDArray[np.uint8]:
    """The RGB picture `(height, width, 3)` in a message, taken by a camera.

    Raises:
        MessageError: the picture has another encoding or is cut off, or the camera's intrinsics are for
            pictures of another size: what is seen in it would be elsewhere.
    """
    height, width, n = message.height, message.width, len(message.data)
    if message.encoding != "rgb8" or message.step != 3 * width or n != 3 * width * height or not n:
        raise MessageError(
            f"picture of {width} x {height} in '{message.encoding}', {n} bytes in rows of {message.step}; "
            "allowed: rgb8, 3 bytes a pixel, without padding"
        )
    if (camera.width, camera.height) != (width, height):
        size = f"{camera.width} x {camera.height}"
        raise MessageError(f"picture of {width} x {height} but intrinsics of {size}")
    return np.frombuffer(message.data, dtype=np.uint8).reshape(height, width, 3)


MM = 1e-3
"""A millimetre [m], the unit of 16UC1 (REP 118)."""
FARTHEST = 65.535
"""Depth that 16 bits can tell [m]."""


def to_depth_image(time: float, depth: Array, frame: str) -> Image:
    """A message of depths `(height, width)` [m] in whole millimetres; 0 where nothing was measured."""
    height, width = depth.shape
    message = Image(height=height, width=width, encoding="16UC1", step=2 * width)
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    message.data = array("B", np.rint(np.clip(depth, 0.0, FARTHEST) / MM).astype("<u2").tobytes())
    return message


def from_depth_image(message: Image, camera: PinholeCamera) -> Array:
    """The depths `(height, width)` [m] in a message, taken by a camera.

    Raises:
        MessageError: the image has another encoding or another size than the camera's, or is cut off.
    """
    height, width, n = message.height, message.width, len(message.data)
    is_whole = message.step == 2 * width and n == 2 * width * height
    if message.encoding != "16UC1" or message.is_bigendian or not is_whole:
        raise MessageError(
            f"depth image of {width} x {height} in '{message.encoding}', {n} bytes in rows of "
            f"{message.step}; allowed: 16UC1, little-endian, 2 bytes a pixel, without padding"
        )
    if (camera.width, camera.height) != (width, height):
        size = f"{camera.width} x {camera.height}"
        raise MessageError(f"depth image of {width} x {height} but intrinsics of {size}")
    return np.asarray(MM * np.frombuffer(message.data, dtype="<u2").reshape(height, width))


def from_camera_info(message: CameraInfo, X_WC: Pose) -> PinholeCamera:
    """The camera with these intrinsics that is at X_WC.

    Raises:
        MessageError: it has distortion, pixels that are not square, or no focal length, or its pictures
            are not those that K is about: they are binned, or a part of the sensor's.
    """
    part, binning = message.roi, (message.binning_x, message.binning_y)
    is_whole = part.x_offset == part.y_offset == 0 and part.width in (0, message.width)
    if max(binning) > 1 or not is_whole or part.height not in (0, message.height):
        raise MessageError(
            f"camera with binning {binning} and a region of {part.width} x {part.height} pixels at "
            f"({part.x_offset}, {part.y_offset}); allowed: none, K is about whole pictures"
        )
    # K = [[f, 0, c_u], [0, f, c_v], [0, 0, 1]]; a focal length below 0 would mirror the picture.
    K = finite(message.k, "intrinsic matrix").reshape(3, 3)
    f = float(K[0, 0])
    if f <= 0.0 or abs(K[1, 1] - f) > 1e-6 * f or K[0, 1] or np.any(finite(message.d, "distortion")):
        raise MessageError(
            f"camera with K {K.ravel().tolist()} and distortion {list(message.d)}; "
            "allowed: square pixels, no distortion"
        )
    return PinholeCamera(X_WC, f, (float(K[0, 2]), float(K[1, 2])), message.width, message.height)


def to_camera_info(time: float, camera: PinholeCamera, frame: str) -> CameraInfo:
    """A message with the intrinsics of a camera without distortion."""
    message = CameraInfo(height=camera.height, width=camera.width, distortion_model="plumb_bob")
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    message.d, message.k, message.r = [0.0] * 5, camera.K.ravel().tolist(), np.eye(3).ravel().tolist()
    message.p = np.column_stack([camera.K, np.zeros(3)]).ravel().tolist()
    return message
