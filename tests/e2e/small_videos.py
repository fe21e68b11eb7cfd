"""The `pack` command with small videos of few frames, which a machine without a graphics card draws soon.

Started as `python -m e2e.small_videos demo packing ...`.
"""

from __future__ import annotations

import sys
from functools import partial
from importlib import import_module

from pack_bringup.cli.main import main

WIDTH, HEIGHT = 320, 184
SHADOW_SIZE = 512
FPS = 5
"""Frames a second, of video and of what it shows."""


def shrink_videos(cell: str) -> None:
    """Change the size and the rate that a cell's videos have, and leave out what takes longest to draw."""
    video_file, video = (import_module(f"pack_evaluation.{name}") for name in ("video_file", f"{cell}.video"))
    assert video.FPS == video_file.FPS == 25
    video.FPS = video_file.FPS = FPS
    if cell == "packing":
        video.ViewConfig = partial(video.ViewConfig, width=WIDTH, height=HEIGHT, shadow_size=SHADOW_SIZE)
        return
    assert (video.WIDTH, video.HEIGHT) == (960, 540)
    video.WIDTH, video.HEIGHT = WIDTH, HEIGHT
    if cell == "palletizing":  # three quarters of the time
        video.CellView = partial(video.CellView, shadows=False)


if __name__ == "__main__":
    # no other command draws a video, nor imports what draws one, which takes a second and a half
    if sys.argv[1] == "demo":
        shrink_videos(sys.argv[2])
    main()
