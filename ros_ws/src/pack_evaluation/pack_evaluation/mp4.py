"""A video file, written picture by picture."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Protocol

import imageio_ffmpeg
import numpy as np

from pack_evaluation.captions import Picture

FPS = 25
"""Frames a second of the video."""


class SendFrame(Protocol):
    """Appends a picture, of the video's size, to it."""

    def __call__(self, picture: Picture) -> None: ...


@contextmanager
def h264_video(path: Path, width: int, height: int) -> Iterator[SendFrame]:
    """A video of H.264 as MP4, of even width and height [pixel], whole when the block is left."""
    video = imageio_ffmpeg.write_frames(
        path, (width, height), fps=FPS, codec="libx264", quality=7, macro_block_size=4,
        output_params=["-preset", "veryfast"],
    )  # fmt: skip
    with closing(video):
        video.send(None)
        yield lambda picture: video.send(np.ascontiguousarray(picture))
