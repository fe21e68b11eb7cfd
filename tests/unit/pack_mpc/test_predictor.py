"""The predicted state is the one that the driver brings about."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.joints import Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_mpc.controller import Predictor
from pack_mpc.plant import PackingPlant
from pack_sim.packing.simulator import Simulator, SimulatorConfig


@pytest.fixture
def simulator(scene: Scene) -> Simulator:
    return Simulator(packing_cell(), scene, SimulatorConfig(), np.random.default_rng(0))


def swing(simulator: Simulator) -> Setpoints:
    """Setpoints that move every joint, with some feed-forward torque."""
    offsets = np.linspace(0.0, 0.3, 31)
    v = np.array([0.4, 0.3, -0.4, 0.3, 0.5, -0.5, 0.6])
    q = simulator.joints().q + offsets[:, None] * v
    return Setpoints(simulator.time, offsets, q, np.tile(v, (31, 1)), np.tile(0.5 * np.sign(v), (31, 1)))


def run(simulator: Simulator, duration: float) -> None:
    for _ in range(round(duration / simulator.config.timestep)):
        simulator.step()


@pytest.mark.parametrize("latency", [0.012, 0.048, 0.096])
def test_prediction_agrees_with_the_driver(
    scene: Scene, plant: PackingPlant, simulator: Simulator, latency
) -> None:
    setpoints = swing(simulator)
    simulator.accept(setpoints)
    run(simulator, 0.06)
    x = plant.state(simulator.joints(), simulator.truth())
    predicted = Predictor(scene.description(), packing_cell()).predict(x, (setpoints,), latency)
    simulator.accept(setpoints)
    run(simulator, latency)
    np.testing.assert_allclose(predicted[plant.layout.q], simulator.joints().q, atol=4e-3)
    np.testing.assert_allclose(predicted[plant.layout.v], simulator.joints().v, atol=0.06)
    assert predicted[0] == pytest.approx(simulator.time)


def test_prediction_agrees_with_a_driver_that_waits_for_the_time_of_the_next_setpoints(
    scene: Scene, plant: PackingPlant, simulator: Simulator
) -> None:
    before = swing(simulator)
    simulator.accept(before)
    run(simulator, 0.06)
    # at two thirds of the speed from where the arm is by then
    begins = simulator.time + 0.03
    q, slower = before.at(begins)[0], 2.0 / 3.0 * before.v
    after = replace(before, time=begins, q=q + before.offsets[:, None] * slower, v=slower)
    simulator.accept(after)
    x = plant.state(simulator.joints(), simulator.truth())
    predictor = Predictor(scene.description(), packing_cell())
    run(simulator, 0.06)
    q = simulator.joints().q
    np.testing.assert_allclose(predictor.predict(x, (before, after), 0.06)[plant.layout.q], q, atol=1.5e-3)
    for wrong in (before, after):
        assert np.abs(predictor.predict(x, (wrong,), 0.06)[plant.layout.q] - q).max() > 3e-3


def test_without_setpoints_the_arm_is_predicted_to_stay(
    scene: Scene, plant: PackingPlant, simulator: Simulator
) -> None:
    x = plant.state(simulator.joints(), simulator.truth())
    predicted = Predictor(scene.description(), packing_cell()).predict(x, (), 0.096)
    np.testing.assert_allclose(predicted[plant.layout.q], simulator.joints().q, atol=1e-6)
