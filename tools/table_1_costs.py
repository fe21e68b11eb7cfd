"""Draws docs/images/packing_table_1.png: `python tools/table_1_costs.py`. It takes some minutes.

A scene for tuning is packed with Table I as printed, and in two steps in the reading of the preset `paper`.
At every moment each term of the cost is what it would add up to if everything stayed as it is for the whole
horizon, (T w + w_f) n(r): what is weighed against each other once the arm has come to rest.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pack_core.packing.goals import PackingMethod
from pack_core.paths import project_root
from pack_core.rotations import Array
from pack_lockstep.packing.lockstep import Lockstep, Step
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import WeightSet, load_weights
from pack_mpc.plant import PackingPlant
from pack_sim.packing.scene_generator import generate_scene

TERMS = {
    "position": "position", "force": "end-effector force", "joint_limit": "joint limits",
    "obstacle": "repulsion", "upright": "upright",
}  # fmt: skip
"""Terms that are drawn, by their names in the legend; the joints' speeds are nearly zero."""
PRESETS = {
    "paper_printed": "Table I as printed",
    "paper_integral": "running weights x 0.006",
    "paper": "and the force's / 900",
}
STAGES = {"PRE_PACK": "#eeeeee", "INSERT": "#dcebf7", "FINE_TUNE": "#dff2df"}
SHOWN = 8.0
"""Part of a run that is drawn [s]."""
FLOOR = 1e-4
"""Least cost that is drawn."""


@dataclass
class Course:
    """What is drawn of a run, a number each cycle.

    Attributes:
        times: since the goal was accepted [s].
        stages: names of the stages.
        heights: of the held object over its packing pose [cm].
        costs: of each term by its name.
    """

    times: list[float] = field(default_factory=list)
    stages: list[str] = field(default_factory=list)
    heights: list[float] = field(default_factory=list)
    costs: dict[str, list[float]] = field(default_factory=lambda: {term: [] for term in TERMS})


def course_of(name: str, seed: int) -> Course:
    """Pack the scene of a seed under the preset of this name."""
    preset = load_preset(name).over("mpc", {"task": {"timeout": SHOWN}})
    cell, config = preset.packing_cell(), lockstep_config(preset)
    weights = load_weights(config.session.weights).times(config.session.weight_factors)
    lockstep = Lockstep(cell, generate_scene(seed, cell), config, PackingMethod.PACK_IT_IN, seed)
    controller = config.session.controller
    optimizer = getattr(controller, controller.optimizer)
    plant = PackingPlant(lockstep.session.scene, cell, timestep=optimizer.timestep, threads=1)
    course, start = Course(), lockstep.simulator.time

    def note(step: Step) -> None:
        if step.plan is None or lockstep.session.task.machine is None:
            return
        course.times.append(step.time - start)
        course.stages.append(step.stage)
        course.heights.append(height_of(lockstep, step))
        for term, cost in resting_costs(lockstep, plant, weights, step, optimizer.horizon).items():
            course.costs[term].append(max(cost, FLOOR))

    lockstep.run(note)
    return course


def height_of(lockstep: Lockstep, step: Step) -> float:
    """Height of the held object over its packing pose, over the base while it has none [cm]."""
    machine = lockstep.session.task.machine
    held = step.truth.objects[lockstep.session.scene.new_object.name].X_WO.p
    return 1e2 * float(held[2] - machine.placement.X_WN.p[2]) if machine else 0.0


def resting_costs(
    lockstep: Lockstep, plant: PackingPlant, weights: WeightSet, step: Step, horizon: int
) -> dict[str, float]:
    """What each term costs over a horizon in which nothing moves."""
    machine, plan = lockstep.session.task.machine, step.plan
    assert machine is not None
    assert plan is not None
    x0 = plant.state(step.seen.joints, step.seen.scene)
    us: Array = plan.solution.setpoints.fed_forward[:1]
    xs, ys = plant.rollout(x0, us[None])
    still = np.repeat(xs[:, :1], horizon + 1, axis=1), np.repeat(ys[:, :1], horizon + 1, axis=1)
    residuals = Residuals(plant, weights, machine.target)
    in_force = weights.in_force(machine.stage, step.time - machine.stage_start)
    costs = {}
    for term in TERMS:
        others = {name: 0.0 for name in in_force.running if name != term}
        alone = PackingCost(residuals, in_force.times(others), torque=0.0)
        costs[term] = float(alone.value(*still, np.zeros((1, horizon, 7)))[0])
    return costs


def draw(top: Axes, bottom: Axes, course: Course, title: str) -> None:
    """Costs over time above, the height below."""
    for term, label in TERMS.items():
        top.semilogy(course.times, course.costs[term], label=label, lw=1.4)
    bottom.plot(course.times, course.heights, color="black", lw=1.4)
    for axes in (top, bottom):
        shade(axes, course)
        axes.set_xlim(0.0, SHOWN)
    top.set_title(title, fontsize=10)
    top.set_ylim(FLOOR, 300.0)
    bottom.set_ylim(-1.0, 32.0)
    bottom.set_xlabel("time [s]")


def shade(axes: Axes, course: Course) -> None:
    """Lay the stages behind the curves."""
    ends = [i for i in range(1, len(course.times)) if course.stages[i] != course.stages[i - 1]]
    for first, last in zip([0, *ends], [*ends, len(course.times) - 1], strict=True):
        axes.axvspan(course.times[first], course.times[last], color=STAGES[course.stages[first]], lw=0.0)


def main() -> None:
    """Draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=62, help="seed of the scene, of those for tuning")
    parser.add_argument(
        "--output", type=Path, default=project_root() / "docs" / "images" / "packing_table_1.png"
    )
    given = parser.parse_args()
    mpl.use("Agg")
    figure = Figure(figsize=(10.0, 5.0), layout="constrained")
    axes = figure.subplots(2, len(PRESETS), sharex="col", sharey="row", height_ratios=(2, 1))
    for column, (preset, title) in enumerate(PRESETS.items()):
        draw(axes[0, column], axes[1, column], course_of(preset, given.seed), title)
    axes[0, 0].set_ylabel("cost of staying, (T w + w_f) n(r)")
    axes[1, 0].set_ylabel("height [cm]")
    axes[0, -1].legend(fontsize=8, loc="upper right")
    figure.savefig(given.output, dpi=100)


if __name__ == "__main__":
    main()
