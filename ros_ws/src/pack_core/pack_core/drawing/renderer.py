"""A renderer without a screen, and a pinhole camera for it."""

from __future__ import annotations

import os

import mujoco

from pack_core.camera import PinholeCamera
from pack_core.errors import PackError
from pack_core.rotations import to_matrix

NEAR, FAR = 0.05, 30.0
"""Nearest and farthest distance that the picture of a pinhole camera shows [m]."""


def open_renderer(model: mujoco.MjModel, width: int, height: int) -> mujoco.Renderer:
    """A renderer of pictures `(height, width, 3)`, bound to the thread that calls this.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    visual = model.vis.global_
    visual.offwidth, visual.offheight = max(visual.offwidth, width), max(visual.offheight, height)
    try:
        return mujoco.Renderer(model, height, width)
    except Exception as error:  # whatever the platform's OpenGL raises
        backend = os.environ.get("MUJOCO_GL", "not set")
        raise PackError(
            f"cannot draw without a screen: {error} (MUJOCO_GL is {backend}); install EGL, `sudo apt-get "
            "install libegl1 libopengl0 libgl1-mesa-dri`, and set MUJOCO_GL=egl, or use --no-video where a "
            "command offers it"
        ) from error


def look_through(camera: PinholeCamera, scene: mujoco.MjvScene) -> None:
    """Give both cameras of the scene, one for each eye, the pose and the intrinsics of a pinhole camera."""
    R_WC = to_matrix(camera.X_WC.q)
    scale = NEAR / camera.f
    for eye in scene.camera:
        eye.pos[:], eye.forward[:], eye.up[:] = camera.X_WC.p, R_WC[:, 2], -R_WC[:, 1]
        eye.frustum_near, eye.frustum_far = NEAR, FAR
        # Pixel centres have whole coordinates, so that the picture reaches from -0.5 to its size less 0.5.
        eye.frustum_top = scale * (camera.c[1] + 0.5)
        eye.frustum_bottom = -scale * (camera.height - camera.c[1] - 0.5)
        eye.frustum_center = scale * (0.5 * camera.width - camera.c[0] - 0.5)
        eye.frustum_width = scale * 0.5 * camera.width
