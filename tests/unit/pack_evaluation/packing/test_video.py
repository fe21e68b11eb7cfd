import os
from pathlib import Path

import imageio_ffmpeg
import mujoco
import numpy as np
import pytest

from pack_core.errors import PackError
from pack_evaluation.packing.video import add_caption, frame_times, write_video
from pack_evaluation.packing.view import View, ViewConfig
from pack_evaluation.video_file import FPS, write_gif
from unit.pack_evaluation.packing.runs import END, START, make_run

SMALL = ViewConfig(width=160, height=96, shadow_size=256)


def test_frames_are_evenly_spaced_and_cover_the_goal() -> None:
    times = frame_times(make_run())
    assert np.diff(times) == pytest.approx(1.0 / FPS)
    assert times[0] < START
    assert times[-1] > END


def test_the_packing_pose_is_drawn_as_a_ghost() -> None:
    run = make_run()
    with View(run, SMALL) as view:
        plain, ghost = view.picture(END, ghost=False), view.picture(END)
    assert plain.shape == (96, 160, 3)
    assert np.any(plain != ghost)


def test_the_caption_covers_the_lower_edge_only() -> None:
    picture = np.full((360, 640, 3), 60, dtype=np.uint8)
    captioned = add_caption(picture, make_run(), START + 1.0)
    changed = np.any(captioned != picture, axis=(1, 2))
    assert np.flatnonzero(changed).tolist() == list(range(330, 360))


def test_a_video_has_every_frame_and_a_gif_comes_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0})  # a process that draws takes 3 s to start
    run = make_run(start=START, end=START + 0.2)
    done: list[float] = []
    write_video(run, tmp_path / "run.mp4", done.append, SMALL)
    write_gif(tmp_path / "run.mp4", tmp_path / "run.gif", width=80)
    assert imageio_ffmpeg.count_frames_and_secs(tmp_path / "run.mp4")[0] == len(frame_times(run))
    assert (tmp_path / "run.gif").read_bytes().startswith(b"GIF89a")
    assert done[-1] == 1.0


def test_without_opengl_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no display device")

    monkeypatch.setattr(mujoco, "Renderer", fail)
    with pytest.raises(PackError, match=r"no display device.*libegl1.*--no-video"):
        View(make_run(), SMALL)
