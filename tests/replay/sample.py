"""The recordings that the replay tests feed through the cores; bags/README.md says how they were made."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from pack_core.packing.scene import Scene
from pack_core.paths import bags_path
from pack_core.ros.contracts import packing as contracts
from pack_evaluation.bag import Bag, read_bag
from pack_evaluation.packing.from_bag import to_run
from pack_evaluation.packing.run import Run

COUNTS = {"/joint_states": 3700, "/mocap/markers": 888, "/scene": 917, "/mpc/status": 52}
"""Messages that the packing cell's sample holds; scores count for nothing if frames are missing."""
SEED = 5
"""Of the goal."""


@cache
def sample_of(cell: str) -> Bag:
    """The sample of a cell, all its topics."""
    return read_bag(bags_path() / "samples" / cell)


def sample() -> Bag:
    """The packing cell's sample."""
    return sample_of("packing")


def sample_path() -> Path:
    """The sample's folder."""
    return bags_path() / "samples" / "packing"


def sample_scene() -> Scene:
    """The cell's description in the sample."""
    return Scene.from_yaml(sample().of(contracts.DESCRIPTION.name)[-1].data)


def sample_run() -> Run:
    """The sample's goal as arrays."""
    return to_run(sample())
