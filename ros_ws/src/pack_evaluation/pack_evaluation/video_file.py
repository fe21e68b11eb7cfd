"""Video files: H.264, written picture by picture, and an animated GIF made of one."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Protocol

import imageio_ffmpeg
import numpy as np

from pack_core.errors import PackError
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


def write_gif(video: Path, path: Path, *, width: int = 640, fps: int = 10, colours: int = 96) -> None:
    """Turn a video into an animated GIF with a palette of its own.

    Raises:
        PackError: the video cannot be read.
    """
    filters = (
        f"fps={fps},scale={width}:-1:flags=lanczos,split[a][b];"
        f"[a]palettegen=max_colors={colours}[p];[b][p]paletteuse=dither=bayer:bayer_scale=4"
    )
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", "-i", str(video)]
    done = subprocess.run([*command, "-vf", filters, str(path)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise PackError(f"cannot turn {video} into {path}: {done.stderr.strip()}")
