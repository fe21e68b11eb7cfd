"""Stages are expensive to set up: one for each light and module."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from unit.pack_perception.boxes.spawns import LIGHTS, NOMINAL, Stage


@pytest.fixture(scope="module")
def nominal() -> Iterator[Stage]:
    """The cell as it is."""
    stage = Stage(NOMINAL)
    yield stage
    stage.close()


@pytest.fixture(scope="module", params=LIGHTS[2::2], ids=lambda light: light.name)
def lit(request: pytest.FixtureRequest) -> Iterator[Stage]:
    """Every other light, the worst among them, in turn; the benchmark has them all."""
    stage = Stage(request.param)
    yield stage
    stage.close()
