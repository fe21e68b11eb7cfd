"""The overhead camera: pictures of the blocks cell without a screen."""

from __future__ import annotations

from collections.abc import Mapping
from types import TracebackType
from typing import Self

import mujoco

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.model import CAMERA, build_model
from pack_core.blocks.problem import CUBES, BlockSizes
from pack_core.camera import Picture
from pack_core.drawing.renderer import open_renderer
from pack_core.errors import PackError
from pack_core.rotations import Array

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class OverheadCamera:
    """Draws snapshots of a simulator; a context manager, bound to the thread that entered it.

    Args:
        cell: whose camera it is.
        tags: the number of every block's tag, as the simulator has them.
        timestep: as the simulator has it.
        shadows: draw them, which takes about twice as long.
        sizes: of the blocks that are not cubes, by id.

    Raises:
        PackError: on entering, where there is no OpenGL to draw with.
    """

    def __init__(
        self, cell: BlocksCell, tags: Mapping[str, int], timestep: float, *, shadows: bool = False,
        sizes: BlockSizes = CUBES,
    ) -> None:  # fmt: skip
        self._camera, self._shadows = cell.camera, shadows
        self._model = build_model(cell, tags, sizes, timestep=timestep, visuals=True)
        self._data = mujoco.MjData(self._model)
        self._renderer: mujoco.Renderer | None = None

    def __enter__(self) -> Self:
        self._renderer = open_renderer(self._model, self._camera.width, self._camera.height)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def picture(self, snapshot: Array) -> Picture:
        """The cell as it was when the snapshot was taken, `(height, width, 3)` RGB."""
        if self._renderer is None:
            raise PackError("the camera is not open; use it as a context manager")
        mujoco.mj_setState(self._model, self._data, snapshot, STATE)
        mujoco.mj_forward(self._model, self._data)
        self._renderer.update_scene(self._data, CAMERA)
        flags = self._renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self._shadows
        flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        picture: Picture = self._renderer.render()
        return picture
