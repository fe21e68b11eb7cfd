"""Pictures of runs that failed: their last moment, and videos of some."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PIL import Image

from pack_evaluation.packing.overlay import add_caption
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.study.trial import PackingStudy
from pack_evaluation.packing.video import write_video
from pack_evaluation.packing.view import View, ViewConfig
from pack_evaluation.study import Picture

SIZE = {"width": 640, "height": 360}


def failure_pictures(study: PackingStudy, folder: Path, *, count: int, videos: int) -> list[Picture]:
    """Every failed run of a study: the last moment of the first `count`, and `videos` of them whole.

    Args:
        study: the runs.
        folder: for the files; made if it is missing and something is drawn.
        count: how many are drawn.
        videos: how many are rendered as MP4.

    Raises:
        PackError: there is no OpenGL to draw with, or a run cannot be read.
    """
    shown = []
    for i, trial in enumerate(study.failures):
        m = trial.measures
        picture = Picture(trial.name, f"{m.exit_reason.value}, {trial.message}; {m.placements} placements")
        if i < count and study.load is not None:
            picture = _drawn(picture, study.load(trial.name), folder, with_video=i < videos)
        shown.append(picture)
    return shown


def _drawn(picture: Picture, run: Run, folder: Path, *, with_video: bool) -> Picture:
    folder.mkdir(parents=True, exist_ok=True)
    stem = picture.name.strip("/").replace("/", "_")  # a recording is named by its path
    image, video = folder / f"{stem}.png", folder / f"{stem}.mp4" if with_video else None
    _write_last(run, image)
    if video:
        write_video(run, video)
    return replace(picture, image=image, video=video)


def _write_last(run: Run, path: Path) -> None:
    with View(run, ViewConfig().model_copy(update=SIZE)) as view:
        Image.fromarray(add_caption(view.picture(run.end), run, run.end)).save(path)
