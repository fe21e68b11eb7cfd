"""Video files: H.264, written picture by picture, and an animated GIF made of one."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path

import imageio_ffmpeg
import numpy as np

from pack_core.camera import Picture
from pack_core.errors import PackError

FPS = 25
"""Frames a second of the video."""


def write_video(
    path: Path,
    size: tuple[int, int],
    frames: Iterable[Picture],
    count: int,
    progress: Callable[[float], None] = lambda _: None,
) -> None:
    """Write frames as H.264 MP4 while they are drawn.

    Args:
        path: the file to write.
        size: width and height [pixel], both even.
        frames: the pictures in order, of this size.
        count: how many they are.
        progress: called with the fraction that is written.
    """
    video = imageio_ffmpeg.write_frames(
        path, size, fps=FPS, codec="libx264", quality=7, macro_block_size=4,
        output_params=["-preset", "veryfast"],
        ffmpeg_log_level="fatal",  # after Ctrl-C it would tell of the frame that was cut off
    )  # fmt: skip
    with closing(video):
        video.send(None)
        for i, frame in enumerate(frames, 1):
            video.send(np.ascontiguousarray(frame))
            progress(i / count)


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
