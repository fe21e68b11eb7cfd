"""Pictures of the palletizing cell from any camera, without a screen."""

from __future__ import annotations

from collections.abc import Mapping
from types import TracebackType
from typing import Self

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.camera import PinholeCamera
from pack_core.drawing.renderer import look_through, open_renderer
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.furniture import BOARD, CARDBOARDS
from pack_core.palletizing.model import build_model
from pack_core.rotations import Array, Pose, to_matrix

Picture = npt.NDArray[np.uint8]


class CellView:
    """Draws the arm and boxes at given poses; a context manager, bound to the thread that made it.

    Boxes are drawn into the picture rather than built into the model: they come and go at no cost.

    Args:
        cell: the cell's physical facts.
        width: of the pictures [pixel].
        height: of the pictures [pixel].
        shadows: whether lights cast shadows, at about three times the cost.
        X_WB: pose of the arm's base; by default the nominal one.

    Raises:
        PackError: there is no OpenGL to draw with.
    """

    def __init__(
        self,
        cell: PalletizingCell,
        width: int,
        height: int,
        *,
        shadows: bool = True,
        X_WB: Pose | None = None,
    ) -> None:  # fmt: skip
        self._model = build_model(cell, look=True, X_WB=X_WB)
        self._model.vis.global_.offwidth, self._model.vis.global_.offheight = width, height
        self._data = mujoco.MjData(self._model)
        self._shadows = shadows
        self._materials = [self._model.material(f"cardboard_{i}").id for i in range(CARDBOARDS)]
        self._board = self._model.material(BOARD).id
        self._renderer = open_renderer(self._model, width, height)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._renderer.close()

    def picture(
        self, q: Array, boxes: Mapping[BoxBody, Pose], camera: PinholeCamera | mujoco.MjvCamera
    ) -> Picture:
        """The cell with the arm at `q` `(6,)` and boxes at X_WB, `(height, width, 3)` RGB."""
        self._data.qpos[:6] = q
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        scene = self._renderer.scene
        pinhole = isinstance(camera, PinholeCamera)
        self._renderer.update_scene(self._data, mujoco.MjvCamera() if pinhole else camera)
        if isinstance(camera, PinholeCamera):
            look_through(camera, scene)
        scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self._shadows
        for box, X_WB in boxes.items():
            self._add_box(scene, box, X_WB)
        picture: Picture = self._renderer.render()
        return picture

    def _add_box(self, scene: mujoco.MjvScene, box: BoxBody, X_WB: Pose) -> None:
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(
            geom, mujoco.mjtGeom.mjGEOM_BOX, box.half_extents, X_WB.p, to_matrix(X_WB.q).ravel(),
            np.ones(4, dtype=np.float32),
        )  # fmt: skip
        is_board = box.name == CALIBRATION_BOARD.name
        geom.matid = self._board if is_board else self._materials[box.look % CARDBOARDS]
        geom.category = mujoco.mjtCatBit.mjCAT_DYNAMIC  # decoration would cast no shadow
        scene.ngeom += 1
