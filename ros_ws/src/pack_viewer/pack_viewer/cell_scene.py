"""What a cell draws in three dimensions, live and in replays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from viser import SceneApi

from pack_viewer.news import News, Topics


class CellScene(ABC):
    """Arm, furniture and objects of a cell.

    Args:
        scene: the page's 3D scene.
    """

    topics: ClassVar[Topics]
    """What it listens to."""

    @abstractmethod
    def __init__(self, scene: SceneApi) -> None: ...

    @abstractmethod
    def update(self, news: News) -> None:
        """Draw what has become known, and move what has moved."""
