"""Rates of topics as steps of the physics, and their names in the wiring tables."""

from __future__ import annotations

from importlib import import_module

import pytest

from pack_core import topics
from pack_core.cells import CELLS
from pack_core.ros.contracts.table import recorded


@pytest.mark.parametrize(
    ("rate", "timestep", "steps"),
    [(500.0, 0.001, 2), (250.0, 0.002, 2), (250.0 / 3.0, 0.004, 3), (50.0, 0.004, 5)],
)
def test_a_rate_becomes_whole_steps(rate: float, timestep: float, steps: int) -> None:
    assert topics.steps_between(rate, timestep) == steps


def test_a_topic_faster_than_the_physics_comes_with_every_step() -> None:
    assert topics.steps_between(1000.0, 0.002) == 1


@pytest.mark.parametrize("cell", CELLS)
def test_every_topic_that_is_named_without_ros_is_recorded(cell: str) -> None:
    modules = (topics, import_module(f"pack_core.{cell}.topics"))
    named = {
        value
        for module in modules
        for name, value in vars(module).items()
        if name.isupper() and type(value) is str
    }
    assert named
    assert named <= {contract.name for contract in recorded(cell)}
