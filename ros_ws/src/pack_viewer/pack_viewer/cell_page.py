"""What a cell adds to the page: its part of the 3D scene, of the state, and panels of its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from viser import SceneApi

from pack_core.rotations import Array
from pack_viewer.news import News, Topics

if TYPE_CHECKING:
    from viser import ViserServer

    from pack_viewer.event_log import EventLog


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


@dataclass(frozen=True)
class Headline:
    """The cell's state in a few words, and what it does or waits for."""

    title: str
    note: str = ""
    is_fault: bool = False


UNHEARD = Headline("waiting for the cell", "nothing has been heard of it yet")
IDLE = Headline("ready", "no goal is in progress")


@dataclass(frozen=True)
class CameraPreset:
    """A place to look from.

    Attributes:
        name: on its button.
        position: where the camera is [m].
        look_at: the point in the middle of the picture [m].
    """

    name: str
    position: tuple[float, float, float]
    look_at: tuple[float, float, float]


def preset_from_angles(
    name: str, look_at: tuple[float, float, float], distance: float, azimuth_deg: float, elevation_deg: float
) -> CameraPreset:
    """A preset from MuJoCo's description of a camera, as the videos of the cells use it."""
    azimuth, elevation = np.radians((azimuth_deg, elevation_deg))
    forward: Array = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    position = np.array(look_at) - distance * forward
    return CameraPreset(name, tuple(position.tolist()), look_at)


class CellPage(ABC):
    """A cell's part of the page; made anew for every page.

    Args:
        server: the page.
        log: where events go.

    Attributes:
        headline: the cell's state in a few words.
    """

    topics: ClassVar[Topics]
    """What the cell's part listens to, its scene included."""
    scene_type: ClassVar[type[CellScene]]
    """What it draws; replays are made of it alone."""
    presets: ClassVar[tuple[CameraPreset, ...]]
    """Where to look from; the first one is how the page opens."""

    def __init__(self, server: ViserServer, log: EventLog) -> None:
        self.server, self.log = server, log
        self.headline = UNHEARD

    @property
    def is_sparing(self) -> bool:
        """Whether to draw few frames, as the machine is busy; by default never."""
        return False

    @abstractmethod
    def tabs(self) -> dict[str, Callable[[], None]]:
        """Panels of the cell's own: a title, and what fills it."""

    def view_options(self) -> None:  # noqa: B027 -- most cells have nothing to choose
        """Add what can be chosen about the view, such as what is shown."""

    @abstractmethod
    def update(self, news: News) -> None:
        """Take in what has come; called once for every frame of the page."""

    @abstractmethod
    def show(self) -> None:
        """Bring texts and plots up to date; called a few times a second."""

    @abstractmethod
    def forget(self) -> None:
        """Time went back, or a new run begins: what happened before is void."""
