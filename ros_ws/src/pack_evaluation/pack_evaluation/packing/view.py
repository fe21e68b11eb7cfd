"""Pictures of a run from its recorded truth, without a screen."""

from __future__ import annotations

from types import TracebackType
from typing import Self

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.bodies import set_object_poses
from pack_core.config import Config
from pack_core.drawing.renderer import open_renderer
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import WALLS, ArmRole, HeldRole, build_model
from pack_core.rotations import Pose, to_matrix
from pack_evaluation.packing.run import Run

Picture = npt.NDArray[np.uint8]
GHOST = (0.15, 0.75, 0.35, 0.35)
"""Colour of the translucent shape at the packing pose, RGBA."""


class ViewConfig(Config):
    """A camera that looks into the container, and the size of its pictures."""

    width: int = 1280
    height: int = 720
    lookat: tuple[float, float, float] = (0.42, 0.0, 0.16)
    distance: float = 1.0
    azimuth_deg: float = 150.0
    elevation_deg: float = -42.0
    wall_opacity: float = 0.45
    shadow_size: int = 2048


class View:
    """Draws a run at any of its times; a context manager, bound to the thread that made it.

    Raises:
        PackError: there is no OpenGL to draw with.
    """

    def __init__(self, run: Run, config: ViewConfig | None = None) -> None:
        self._run, self._config = run, config or ViewConfig()
        cell = packing_cell().with_arm(run.arm)
        self._model = build_model(
            run.scene, cell, timestep=0.002, arm=ArmRole.DRIVEN, held=HeldRole.FREE, surroundings=True
        )
        visual = self._model.vis
        visual.quality.shadowsize = self._config.shadow_size
        visual.global_.offwidth, visual.global_.offheight = self._config.width, self._config.height
        for name in WALLS:
            self._model.geom(name).rgba[3] = self._config.wall_opacity
        self._data = mujoco.MjData(self._model)
        self._arm = [self._model.joint(name).qposadr[0] for name in cell.robot.arm.joints]
        self._renderer = open_renderer(self._model, self._config.width, self._config.height)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._renderer.close()

    def picture(self, time: float, *, ghost: bool = True) -> Picture:
        """The cell at `time` [s], `(height, width, 3)`; `ghost` adds the packing pose."""
        run, times = self._run, np.array([time])
        self._data.qpos[self._arm] = [np.interp(time, run.joint_times, q) for q in run.joints.T]
        set_object_poses(
            self._model, self._data, {name: t.at(times).pose(0) for name, t in run.truth.items()}
        )
        mujoco.mj_forward(self._model, self._data)
        self._renderer.update_scene(self._data, self._camera())
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        if ghost and (X_WT := _target(run, time)) is not None:
            self._add_ghost(X_WT)
        picture: Picture = self._renderer.render()
        return picture

    def _camera(self) -> mujoco.MjvCamera:
        camera = mujoco.MjvCamera()
        camera.lookat[:] = self._config.lookat
        camera.distance = self._config.distance
        camera.azimuth, camera.elevation = self._config.azimuth_deg, self._config.elevation_deg
        return camera

    def _add_ghost(self, X_WT: Pose) -> None:
        """Add the held object's shape at its packing pose, translucent."""
        model, scene = self._model, self._renderer.scene
        geom = model.geom(self._run.scene.new_object.name)
        X_WG = X_WT @ Pose(geom.pos, geom.quat)
        ghost = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(
            ghost, int(geom.type[0]), geom.size, X_WG.p, to_matrix(X_WG.q).ravel(),
            np.array(GHOST, dtype=np.float32),
        )  # fmt: skip
        # MuJoCo draws two pictures of each mesh: the mesh itself, and after it its convex hull
        ghost.dataid = 2 * int(geom.dataid[0])
        scene.ngeom += 1


def _target(run: Run, time: float) -> Pose | None:
    """The packing pose X_WT that is pursued at `time` [s]; None before the first iteration."""
    i = int(np.searchsorted(run.iterations.times, time, side="right")) - 1
    return Pose(run.iterations.p_WT[i], run.iterations.q_WT[i]) if i >= 0 else None
