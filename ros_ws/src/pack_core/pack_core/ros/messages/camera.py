"""Pictures and the camera that took them, as messages."""

from __future__ import annotations

from array import array

import numpy as np
import numpy.typing as npt
from sensor_msgs.msg import CameraInfo, Image

from pack_core.camera import PinholeCamera
from pack_core.errors import MessageError
from pack_core.ros.messages.conversions import finite, to_stamp
from pack_core.rotations import Pose


def to_image(time: float, picture: npt.NDArray[np.uint8], frame: str) -> Image:
    """A message of an RGB picture `(height, width, 3)` that was exposed at `time` [s]."""
    height, width, _ = picture.shape
    message = Image(height=height, width=width, encoding="rgb8", step=3 * width)
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    data = array("B")  # the only type that rclpy takes without checking every byte
    data.frombytes(np.ascontiguousarray(picture).data.cast("B"))
    message.data = data
    return message


def from_image(message: Image) -> npt.NDArray[np.uint8]:
    """The RGB picture `(height, width, 3)` in a message.

    Raises:
        MessageError: the picture has another encoding, or is cut off.
    """
    height, width, n = message.height, message.width, len(message.data)
    if message.encoding != "rgb8" or message.step != 3 * width or n != 3 * width * height or not n:
        raise MessageError(
            f"picture of {width} x {height} in '{message.encoding}', {n} bytes in rows of {message.step}; "
            "allowed: rgb8, 3 bytes a pixel, without padding"
        )
    return np.frombuffer(message.data, dtype=np.uint8).reshape(height, width, 3)


def from_camera_info(message: CameraInfo, X_WC: Pose) -> PinholeCamera:
    """The camera with these intrinsics that is at X_WC.

    Raises:
        MessageError: it has distortion, pixels that are not square, or no focal length.
    """
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
