"""The `pack` command with small videos, which a machine without a graphics card draws soon.

Started as `python -m e2e.small_videos demo packing ...`.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module

from pack_bringup.cli.main import main

WIDTH, HEIGHT = 320, 184
SHADOW_SIZE = 512


def shrink_videos() -> None:
    """Change the size that each cell's videos have."""
    for cell in ("palletizing", "blocks"):
        video = import_module(f"pack_evaluation.{cell}.video")
        assert (video.WIDTH, video.HEIGHT) == (960, 540)
        video.WIDTH, video.HEIGHT = WIDTH, HEIGHT
    video = import_module("pack_evaluation.packing.video")
    video.ViewConfig = partial(video.ViewConfig, width=WIDTH, height=HEIGHT, shadow_size=SHADOW_SIZE)


if __name__ == "__main__":
    shrink_videos()
    main()
