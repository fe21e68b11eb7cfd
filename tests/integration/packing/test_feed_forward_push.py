"""What presses is the torque that setpoints state: without it the arm touches and no more."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.joints import Setpoints
from pack_core.packing.cell import packing_cell
from pack_mpc.cost import PackingCost
from pack_mpc.residuals import Residuals
from pack_mpc.sgn_optimizer import SgnConfig, SgnOptimizer
from pack_mpc.target import PackingTarget
from pack_mpc.weights import Stage, load_weights
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator
from pack_sim.packing.simulator_config import SimulatorConfig

PERIOD = 0.048


def run(simulator: Simulator, duration: float) -> None:
    for _ in range(round(duration / simulator.config.timestep)):
        simulator.step()


def push(simulator: Simulator) -> float:
    """Magnitude of the external force on the held object [N]."""
    return float(np.linalg.norm(simulator.external_wrench()[0]))


@pytest.fixture
def pressed() -> tuple[Simulator, Setpoints]:
    """The cell while its arm presses on the top of the tallest object, and the plan that it follows."""
    cell = packing_cell()
    simulator = Simulator(cell, generate_scene(3, cell), SimulatorConfig(), np.random.default_rng(0))
    tallest = max(simulator.scene.objects, key=lambda item: float(item.half_extents[2]))
    below = simulator.truth().objects[tallest.name].X_WO.p + np.array([0.0, 0.0, -0.05])
    optimizer = SgnOptimizer(simulator.description, cell, SgnConfig(), threads=1)
    target, weights = PackingTarget(below, 0.0, may_land=True), load_weights("tuned")
    residuals = Residuals(optimizer.plant, weights, target)
    cost = PackingCost(residuals, weights.of(Stage.PRE_PACK), weights.torque)
    for _ in range(round(2.0 / PERIOD)):
        x0 = optimizer.plant.state(simulator.joints(), simulator.truth())
        plan = optimizer.improve(x0, cost, Stage.PRE_PACK, target).setpoints
        simulator.accept(plan)
        run(simulator, PERIOD)
    return simulator, plan


def test_the_arm_presses_with_the_torque_of_its_setpoints(pressed: tuple[Simulator, Setpoints]) -> None:
    assert push(pressed[0]) > 5.0


def test_with_that_torque_removed_it_no_longer_presses(pressed: tuple[Simulator, Setpoints]) -> None:
    simulator, plan = pressed
    before = push(simulator)
    for _ in range(6):
        simulator.accept(replace(plan, time=simulator.time, tau=np.zeros_like(plan.tau)))
        run(simulator, 0.05)
    assert push(simulator) < 0.2 * before
