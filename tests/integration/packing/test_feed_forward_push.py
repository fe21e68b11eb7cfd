"""What presses is the torque that setpoints state: without it the arm touches and no more."""

from dataclasses import replace

import numpy as np

from pack_core.packing.cell import packing_cell
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import load_weights
from pack_mpc.optimizers.sgn import SgnConfig, SgnOptimizer
from pack_mpc.target import PackingTarget, Stage
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator, SimulatorConfig

PERIOD = 0.048


def run(simulator: Simulator, duration: float) -> None:
    for _ in range(round(duration / simulator.config.timestep)):
        simulator.step()


def push(simulator: Simulator) -> float:
    """Magnitude of the external force on the held object [N]."""
    return float(np.linalg.norm(simulator.external_wrench()[0]))


def mean_push(*, states_torque: bool) -> float:
    """Mean push [N] in the last of three seconds.

    The arm is sent 5 cm below the top of the tallest object, and the cell is planned for in every cycle.
    Without `states_torque` the plans go out with their torques zero.
    """
    cell = packing_cell()
    simulator = Simulator(cell, generate_scene(3, cell), SimulatorConfig(), np.random.default_rng(0))
    tallest = max(simulator.scene.objects, key=lambda item: float(item.half_extents[2]))
    below = simulator.truth().objects[tallest.name].X_WO.p + np.array([0.0, 0.0, -0.05])
    optimizer = SgnOptimizer(simulator.description, cell, SgnConfig(), threads=1)
    target, weights = PackingTarget(below, 0.0, may_land=True), load_weights("tuned")
    residuals = Residuals(optimizer.plant, weights, target)
    cost = PackingCost(residuals, weights.of(Stage.PRE_PACK), weights.torque)
    pushes = []
    for _ in range(round(3.0 / PERIOD)):
        x0 = optimizer.plant.state(simulator.joints(), simulator.truth())
        plan = optimizer.improve(x0, cost, Stage.PRE_PACK, target).setpoints
        simulator.accept(plan if states_torque else replace(plan, tau=np.zeros_like(plan.tau)))
        run(simulator, PERIOD)
        pushes.append(push(simulator))
    return float(np.mean(pushes[-round(1.0 / PERIOD) :]))


def test_what_presses_is_the_torque_of_the_setpoints() -> None:
    pressed = mean_push(states_torque=True)
    assert pressed > 5.0
    assert mean_push(states_torque=False) < 0.2 * pressed
