"""Pictures of a run from its recorded truth, without a screen."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.bodies import set_object_poses
from pack_core.camera import Picture
from pack_core.config import Config
from pack_core.drawing.renderer import ModelView, add_geom, orbit_camera
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import WALLS, ArmRole, HeldRole, build_model
from pack_core.rotations import Pose
from pack_evaluation.packing.run import Run

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


class View(ModelView):
    """Draws a run at any of its times."""

    def __init__(self, run: Run, config: ViewConfig | None = None) -> None:
        self._run, self._config = run, config or ViewConfig()
        cell = packing_cell().with_arm(run.arm)
        model = build_model(
            run.scene, cell, timestep=0.002, arm=ArmRole.DRIVEN, held=HeldRole.FREE, surroundings=True
        )
        model.vis.quality.shadowsize = self._config.shadow_size
        for name in WALLS:
            model.geom(name).rgba[3] = self._config.wall_opacity
        self._arm = [model.joint(name).qposadr[0] for name in cell.robot.arm.joints]
        super().__init__(model, self._config.width, self._config.height)

    def picture(self, time: float, *, ghost: bool = True) -> Picture:
        """The cell at `time` [s], `(height, width, 3)`; `ghost` adds the packing pose."""
        run, times, config = self._run, np.array([time]), self._config
        self._data.qpos[self._arm] = [np.interp(time, run.joint_times, q) for q in run.joints.T]
        poses = {name: track.at(times).pose(0) for name, track in run.truth.items()}
        set_object_poses(self._model, self._data, poses)
        mujoco.mj_forward(self._model, self._data)
        camera = orbit_camera(config.lookat, config.distance, config.azimuth_deg, config.elevation_deg)
        scene = self._update_scene(camera)
        if ghost and (X_WT := _target(run, time)) is not None:
            self._add_ghost(scene, X_WT)
        return self._render()

    def _add_ghost(self, scene: mujoco.MjvScene, X_WT: Pose) -> None:
        """Add the held object's shape at its packing pose, translucent."""
        geom = self._model.geom(self._run.scene.new_object.name)
        ghost = add_geom(scene, int(geom.type[0]), geom.size, X_WT @ Pose(geom.pos, geom.quat), GHOST)
        # MuJoCo draws two pictures of each mesh: the mesh itself, and after it its convex hull
        ghost.dataid = 2 * int(geom.dataid[0])


def _target(run: Run, time: float) -> Pose | None:
    """The packing pose X_WT that is pursued at `time` [s]; None before the first iteration."""
    i = int(np.searchsorted(run.iterations.times, time, side="right")) - 1
    return Pose(run.iterations.p_WT[i], run.iterations.q_WT[i]) if i >= 0 else None
