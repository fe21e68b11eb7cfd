"""Pictures of the palletizing cell from any camera, without a screen."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco

from pack_core.camera import Picture, PinholeCamera
from pack_core.drawing.renderer import ModelView, add_geom
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.furniture import BOARD, CARDBOARDS
from pack_core.palletizing.model import build_model
from pack_core.rotations import Array, Pose


class CellView(ModelView):
    """Draws the arm and boxes at given poses.

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
        super().__init__(build_model(cell, visuals=True, X_WB=X_WB), width, height)
        self._shadows = shadows
        self._materials = [self._model.material(f"cardboard_{i}").id for i in range(CARDBOARDS)]
        self._board = self._model.material(BOARD).id

    def picture(
        self, q: Array, boxes: Mapping[BoxBody, Pose], camera: PinholeCamera | mujoco.MjvCamera
    ) -> Picture:
        """The cell with the arm at `q` `(6,)` and boxes at X_WB, `(height, width, 3)` RGB."""
        self._data.qpos[:6] = q
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        scene = self._update_scene(camera)
        scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self._shadows
        for box, X_WB in boxes.items():
            self._add_box(scene, box, X_WB)
        return self._render()

    def _add_box(self, scene: mujoco.MjvScene, box: BoxBody, X_WB: Pose) -> None:
        geom = add_geom(scene, mujoco.mjtGeom.mjGEOM_BOX, box.half_extents, X_WB, (1.0, 1.0, 1.0, 1.0))
        is_board = box.name == CALIBRATION_BOARD.name
        geom.matid = self._board if is_board else self._materials[box.appearance % CARDBOARDS]
        geom.category = mujoco.mjtCatBit.mjCAT_DYNAMIC  # decoration would cast no shadow
