"""Pictures of a model without a screen, from a camera that orbits a point or from a pinhole camera."""

from __future__ import annotations

import os
from collections.abc import Sequence
from types import TracebackType
from typing import Self

import mujoco
import numpy as np

from pack_core.camera import Picture, PinholeCamera
from pack_core.errors import PackError
from pack_core.rotations import Array, Pose, to_matrix

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


class ModelView:
    """Draws a model at any state; a context manager, bound to the thread that made it.

    Whoever derives from it sets the state in `_data`, updates the scene, and renders it.

    Args:
        model: the model to draw.
        width: width of the pictures [pixel].
        height: height of the pictures [pixel].

    Raises:
        PackError: there is no OpenGL to draw with.
    """

    def __init__(self, model: mujoco.MjModel, width: int, height: int) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        self._renderer = open_renderer(model, width, height)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._renderer.close()

    def _update_scene(self, camera: PinholeCamera | mujoco.MjvCamera) -> mujoco.MjvScene:
        """Put the state of `_data` into the scene, seen by the camera, and return the scene."""
        scene = self._renderer.scene
        if isinstance(camera, PinholeCamera):
            self._renderer.update_scene(self._data, mujoco.MjvCamera())
            look_through(camera, scene)
        else:
            self._renderer.update_scene(self._data, camera)
        scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        return scene

    def _render(self) -> Picture:
        picture: Picture = self._renderer.render()
        return picture


def orbit_camera(
    lookat: Sequence[float] | Array, distance: float, azimuth_deg: float, elevation_deg: float
) -> mujoco.MjvCamera:
    """A camera that looks at a point from a distance [m], turned round it by two angles."""
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance = lookat, distance
    camera.azimuth, camera.elevation = azimuth_deg, elevation_deg
    return camera


def add_geom(
    scene: mujoco.MjvScene, kind: int, size: Sequence[float] | Array, X_WG: Pose, rgba: Sequence[float]
) -> mujoco.MjvGeom:
    """Add a shape to an updated scene, which the model does not have, and return it."""
    geom = scene.geoms[scene.ngeom]
    mujoco.mjv_initGeom(
        geom, kind, np.asarray(size, dtype=float), X_WG.p, to_matrix(X_WG.q).ravel(),
        np.array(rgba, dtype=np.float32),
    )  # fmt: skip
    scene.ngeom += 1
    return geom


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
