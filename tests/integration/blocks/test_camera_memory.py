"""Cameras that are closed and opened anew for hours, as with every reset of the blocks cell."""

from __future__ import annotations

import os
import queue

import pytest

from pack_bringup.robustness.soak import usage_of
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.problem_file import load_problem
from pack_core.camera import Picture
from pack_core.paths import config_path
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.blocks.simulator import BlocksSimulator
from pack_sim.camera_thread import CameraThread

WARM_UP, OPENINGS = 3, 15
GROWTH = 30.0
"""Of all openings after the first ones [MB]; glibc alone would keep about 130."""


def take_one_picture(simulator: BlocksSimulator) -> None:
    """Open the camera, have it draw, and close it."""
    taken: queue.Queue[tuple[float, Picture]] = queue.Queue()
    camera = OverheadCamera(simulator.cell, simulator.tags, simulator.config.timestep)
    thread = CameraThread(camera, lambda *args: taken.put(args), pytest.fail)
    assert thread.expose(0.0, simulator.snapshot())
    taken.get(timeout=60.0)
    thread.close()


@pytest.mark.long
def test_a_closed_camera_gives_its_memory_back() -> None:
    cell = blocks_cell()
    problem = load_problem(config_path("scenarios", "blocks", "example.yaml"), cell)
    tags = {block.id: number for number, block in enumerate(problem.blocks)}
    simulator = BlocksSimulator(cell, tags, problem.starts)
    memory = []
    for _ in range(OPENINGS):
        take_one_picture(simulator)
        memory.append(usage_of(os.getpid()).memory_mb)
    assert max(memory[WARM_UP:]) - memory[WARM_UP - 1] < GROWTH
