"""An animated GIF made of a video."""

from __future__ import annotations

import subprocess
from pathlib import Path

import imageio_ffmpeg

from pack_core.errors import PackError


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
