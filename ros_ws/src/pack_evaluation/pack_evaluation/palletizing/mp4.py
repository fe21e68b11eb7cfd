"""A video file of the palletizing cell, written picture by picture."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Protocol

import imageio_ffmpeg
import numpy as np

from pack_evaluation.captions import Picture

WIDTH, HEIGHT = 960, 540
FPS = 25
"""Frames a second of the video."""


class SendFrame(Protocol):
    """Appends a picture of WIDTH x HEIGHT to the video."""

    def __call__(self, picture: Picture) -> None: ...


@contextmanager
def h264_video(path: Path) -> Iterator[SendFrame]:
    """A video of H.264 as MP4, whole when the block is left."""
    video = imageio_ffmpeg.write_frames(
        path, (WIDTH, HEIGHT), fps=FPS, codec="libx264", quality=7, macro_block_size=4,
        output_params=["-preset", "veryfast"],
    )  # fmt: skip
    with closing(video):
        video.send(None)
        yield lambda picture: video.send(np.ascontiguousarray(picture))
