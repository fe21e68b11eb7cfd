"""What a video of a calibration shows, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pack_core.camera import Picture
from pack_core.palletizing.boxes import BoxBody
from pack_core.rotations import Array
from pack_evaluation.palletizing.run import StandingCell
from pack_evaluation.track import Track


@dataclass(frozen=True)
class FilmStage:
    """From `time` [s] on something is done: its title, and on what."""

    time: float
    title: str
    what: str


@dataclass(frozen=True)
class FeltForce:
    """What was felt in a touch.

    Attributes:
        times: when samples were taken `(n,)` [s].
        way: of the tool along its approach, by the reported joints, from the moment of contact `(n,)` [m].
        force: along the approach `(n,)` [N].
        off: from where the surface was expected, along the coordinate that is felt [m].
    """

    times: Array
    way: Array
    force: Array
    off: float


@dataclass(frozen=True)
class BoardPicture:
    """A picture that was taken of the board at `time` [s], made small, with corners `(n, 2)` [pixel]."""

    time: float
    picture: Picture
    corners: Array


@dataclass(frozen=True)
class CalibrationFilm:
    """A calibration from its first move to its result.

    Attributes:
        stands: where everything truly is.
        times: moments `(n,)` [s].
        joints: angles of the links at these `(n, 6)` [rad].
        tracks: where things that are laid into the cell truly were.
        stages: what was done, in order.
        touches: what was felt, in order.
        pictures: of the board, in order.
        verdict: what the calibration ended with, in words.
    """

    stands: StandingCell
    times: Array
    joints: Array
    tracks: Mapping[BoxBody, Track]
    stages: tuple[FilmStage, ...]
    touches: tuple[FeltForce, ...]
    pictures: tuple[BoardPicture, ...]
    verdict: str
