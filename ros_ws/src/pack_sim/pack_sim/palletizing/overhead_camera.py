"""The simulated overhead camera of the palletizing cell."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from pydantic import Field

from pack_core.camera import PinholeCamera
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.view import CellView, Picture
from pack_core.rotations import Pose
from pack_sim.palletizing.lens import RealLens
from pack_sim.palletizing.snapshot import Snapshot


class PalletCameraConfig(Config):
    """Parameters of the overhead camera."""

    width: int = Field(default=3840, ge=320, le=7680, description="of pictures [pixel]; the height follows")
    shadows: bool = Field(default=True, description="whether lights cast shadows")


class PalletCamera:
    """Draws what the camera sees; a context manager, bound to the thread that enters it.

    Args:
        cell: the cell as it truly is, with the pose of the camera.
        config: size of the pictures.
        seed: of the camera's noise, where the cell's preset has a real camera.
        X_WB: true pose of the arm's base; by default the nominal one.

    Attributes:
        camera: the true camera without distortion; no part of a control loop may use it where the cell's
            preset has a real camera.
    """

    def __init__(
        self, cell: PalletizingCell, config: PalletCameraConfig, seed: int = 0, X_WB: Pose | None = None
    ) -> None:
        self._cell, self._config, self._X_WB = cell, config, X_WB
        self.camera = camera_of(cell, config)
        errors = cell.imperfections.camera
        self._lens = None if errors is None else RealLens(self.camera, cell.camera.lens, errors, seed)
        self._view: CellView | None = None

    def __enter__(self) -> Self:
        """Start drawing; raises PackError when there is no OpenGL to draw with."""
        drawn = self._drawn
        self._view = CellView(
            self._cell, drawn.width, drawn.height, shadows=self._config.shadows, X_WB=self._X_WB
        )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._view is not None:
            self._view.__exit__(kind, error, trace)
            self._view = None

    def picture(self, snapshot: Snapshot) -> Picture:
        """A picture `(height, width, 3)`, RGB; raises PackError outside a `with` statement."""
        if self._view is None:
            raise PackError("the overhead camera draws only inside a `with` statement")
        picture = self._view.picture(snapshot.q, snapshot.boxes, self._drawn)
        return picture if self._lens is None else self._lens.expose(picture, snapshot.time)

    @property
    def _drawn(self) -> PinholeCamera:
        """The camera whose picture is drawn."""
        return self.camera if self._lens is None else self._lens.drawn


def camera_of(cell: PalletizingCell, config: PalletCameraConfig) -> PinholeCamera:
    """The cell's overhead camera, scaled to pictures of the configured width."""
    return cell.overhead_camera.scaled(config.width)
