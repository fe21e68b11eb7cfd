"""The overhead camera: what it sees of the cell."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from pydantic import Field

from pack_core.camera import PinholeCamera
from pack_core.cells.palletizing import PalletizingCell
from pack_core.config import Config
from pack_core.scene.palletizing.view import CellView, Picture
from pack_sim.palletizing.snapshot import Snapshot


class OverheadCameraConfig(Config):
    """Parameters of the overhead camera."""

    width: int = Field(default=3840, ge=320, le=7680, description="of pictures [pixel]; the height follows")
    shadows: bool = Field(default=True, description="whether lights cast shadows")


class OverheadCamera:
    """Draws what the camera sees; a context manager, bound to the thread that made it.

    Args:
        cell: where the camera is.
        config: size of the pictures.

    Raises:
        PackError: there is no OpenGL to draw with.
    """

    def __init__(self, cell: PalletizingCell, config: OverheadCameraConfig) -> None:
        self.camera = camera_of(cell, config)
        self._view = CellView(cell, self.camera.width, self.camera.height, shadows=config.shadows)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._view.__exit__(kind, error, trace)

    def picture(self, snapshot: Snapshot) -> Picture:
        """What it sees `(height, width, 3)`, RGB."""
        return self._view.picture(snapshot.q, snapshot.boxes, self.camera)


def camera_of(cell: PalletizingCell, config: OverheadCameraConfig) -> PinholeCamera:
    """The camera with pictures of the configured width."""
    return cell.overhead_camera.scaled(config.width)
