"""Draws a run's pictures in parallel processes, because software OpenGL keeps a core busy."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context

from pack_core.rotations import Array
from pack_evaluation.packing.overlay import add_caption
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.view import Picture, View, ViewConfig

_open: dict[str, tuple[Run, View]] = {}


@contextmanager
def drawing_processes(run: Run, config: ViewConfig) -> Iterator[ProcessPoolExecutor]:
    """A pool with one process for each core, each with a view of the run that `draw` uses."""
    with View(run, config):  # without OpenGL this raises a PackError here instead of in a process
        pass
    count = len(os.sched_getaffinity(0))
    with ProcessPoolExecutor(count, get_context("spawn"), _start, (run, config)) as pool:
        yield pool


def draw(times: Array) -> list[Picture]:
    """Pictures of the run with their captions at simulated times [s]; runs in a drawing process."""
    run, view = _open["run"]
    return [add_caption(view.picture(time), run, time) for time in times]


def _start(run: Run, config: ViewConfig) -> None:
    # one thread of the software renderer for each process, since there is a process for each core
    os.environ["LP_NUM_THREADS"] = "1"
    _open["run"] = (run, View(run, config))
