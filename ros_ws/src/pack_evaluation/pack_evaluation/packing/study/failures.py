"""Pictures of runs that failed: their last moment, and videos of some."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from pack_evaluation.packing.overlay import add_caption
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.study.trial import Trial
from pack_evaluation.packing.video import write_video
from pack_evaluation.packing.view import View, ViewConfig

SIZE = {"width": 640, "height": 360}


@dataclass(frozen=True)
class FailurePicture:
    """The last moment of a failed run; `video` is None where none was made."""

    trial: Trial
    picture: Path
    video: Path | None


def show_failures(
    trials: tuple[Trial, ...], load: Callable[[str], Run], folder: Path, *, videos: int = 0
) -> list[FailurePicture]:
    """Draw the end of every given run, and the first `videos` of them whole.

    Args:
        trials: that failed.
        load: the run of a trial by its name.
        folder: for the files.
        videos: how many to render as MP4.

    Raises:
        PackError: there is no OpenGL to draw with, or a run cannot be read.
    """
    folder.mkdir(parents=True, exist_ok=True)
    shown = []
    for i, trial in enumerate(trials):
        run, stem = load(trial.name), trial.name.strip("/").replace("/", "_")
        picture, video = folder / f"{stem}.png", folder / f"{stem}.mp4" if i < videos else None
        _write_last(run, picture)
        if video:
            write_video(run, video)
        shown.append(FailurePicture(trial, picture, video))
    return shown


def _write_last(run: Run, path: Path) -> None:
    with View(run, ViewConfig().model_copy(update=SIZE)) as view:
        Image.fromarray(add_caption(view.picture(run.end), run, run.end)).save(path)
