"""What the thesis shows of every order (8.7 and chapter 9): profiles, the boxes' ways, and both as JSON."""

from __future__ import annotations

import json
from io import BytesIO
from typing import Any

from matplotlib.figure import Figure

from pack_core.rotations import Array
from pack_evaluation.palletizing.plots import DPI, SIZE, Draw, draw_orientation, draw_position, draw_ways
from pack_evaluation.palletizing.run import PalletRun

FIGURES: dict[str, Draw] = {
    "fig_9_2_position": draw_position,
    "fig_9_2_orientation": draw_orientation,
    "fig_9_4_ways": draw_ways,
}
STRIDE = 5
"""Only every fifth sample of the arm is written."""
DECIMALS = 5
"""Of metres, seconds and parts of quaternions in the JSON."""


def chapter_9(run: PalletRun) -> dict[str, bytes]:
    """The figures as PNG and the trajectories as JSON, by file name."""
    files = {f"{name}.png": _png(run, draw) for name, draw in FIGURES.items()}
    return {**files, "trajectories.json": json.dumps(trajectories(run), allow_nan=False).encode()}


def trajectories(run: PalletRun) -> dict[str, Any]:
    """The measured tool with its targets, and the true boxes, as plain values [m, rad, s; wxyz]."""
    tool = run.tool
    robot = {
        "time": tool.times, "joints": tool.joints, "position": tool.p, "orientation": tool.q,
    }  # fmt: skip
    targets = [
        {
            "time": round(target.time, DECIMALS),
            "position": _plain(target.X_WT.p),
            "orientation": _plain(target.X_WT.q),
        }
        for target in run.targets
    ]
    boxes = {
        name: {"time": _plain(track.times), "position": _plain(track.p), "orientation": _plain(track.q)}
        for name, track in run.tracks.items()
    }
    return {
        "order": run.order, "seed": run.seed, "boxes": boxes, "targets": targets,
        "robot": {name: _plain(values[::STRIDE]) for name, values in robot.items()},
        "slow": [[round(time, DECIMALS) for time in interval] for interval in run.slow],
    }  # fmt: skip


def _plain(values: Array) -> Any:
    return values.round(DECIMALS).tolist()


def _png(run: PalletRun, draw: Draw) -> bytes:
    figure, picture = Figure(figsize=SIZE, layout="constrained"), BytesIO()
    draw(figure, run)
    figure.savefig(picture, format="png", dpi=DPI)
    return picture.getvalue()
