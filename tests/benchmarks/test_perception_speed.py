"""Wall time of motion capture and of the estimator, while the arm pushes."""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pack_core.packing.cell import packing_cell
from pack_perception.mocap.physics_estimator import EstimatorConfig, PhysicsEstimator
from pack_sim.packing.simulator import Simulator, SimulatorConfig
from unit.pack_perception.mocap.pushing import CONTACT, Moment, pushing_run, standing_scene

pytestmark = pytest.mark.benchmark


@pytest.fixture(scope="module")
def moments() -> list[Moment]:
    return list(pushing_run(seed=0, until=CONTACT + 1.0))


@pytest.fixture
def estimator(moments: list[Moment]) -> PhysicsEstimator:
    """An estimator that has just seen the objects being pushed."""
    estimator = PhysicsEstimator(standing_scene().description(), packing_cell(), EstimatorConfig())
    for moment in moments:
        estimator.advance(moment.joints)
        for frame in moment.frames:
            estimator.correct(frame)
    return estimator


def test_a_step_takes_under_half_a_millisecond(benchmark: BenchmarkFixture, moments: list[Moment]) -> None:
    estimator = PhysicsEstimator(standing_scene().description(), packing_cell(), EstimatorConfig())
    pushing = [moment.joints for moment in moments if moment.joints.time > CONTACT]
    for moment in moments[: -len(pushing)]:
        estimator.advance(moment.joints)
        for frame in moment.frames:
            estimator.correct(frame)
    samples = iter(pushing[1::2])
    benchmark.pedantic(lambda: estimator.advance(next(samples)), rounds=len(pushing) // 2 - 1)
    assert benchmark.stats.stats.median < 0.5e-3


def test_a_frame_takes_under_two_milliseconds(
    benchmark: BenchmarkFixture, estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    frame = next(moment.frames[0] for moment in reversed(moments) if moment.frames)
    correction = benchmark(estimator.correct, frame)
    assert len(correction.seen) == len(standing_scene().names) + 1
    assert benchmark.stats.stats.median < 2e-3


def test_a_mocap_frame_takes_under_a_millisecond(benchmark: BenchmarkFixture) -> None:
    simulator = Simulator(packing_cell(), standing_scene(), SimulatorConfig(), np.random.default_rng(0))
    frame = benchmark(simulator.mocap.capture, simulator.model, simulator.data, 0.0)
    assert len(frame.p_WM) > 20
    assert benchmark.stats.stats.median < 1e-3
