"""Scenes, orders and problems carried out by setpoints and by trajectories, side by side, in lockstep.

`PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.trajectories blocks --first 0 --number 20` prints for each
problem, and in all, how both ways went: success, duration, by how much a joint was off what its driver asked
of it, and how many trajectories were sent. Trajectories are followed by the tests' own joint trajectory
controller, setpoints by the cell's driver. In packing they are plans with torques, which a relay passes on.
The controller knows of no contact, so `setpoints unbounded` is the cell's driver without its governor.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from foreign_driver.effort_arm import relay_driven
from foreign_driver.lockstep_arm import trajectory_driven
from pack_core.blocks.cell import blocks_cell
from pack_core.config import Config
from pack_core.joints import Desired, Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingMethod
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.robots import kr210, ur10e
from pack_core.rotations import Array
from pack_evaluation.palletizing.measures import measure_order
from pack_lockstep.blocks import execution
from pack_lockstep.blocks.lockstep import BlocksLockstep, CountedPlannerConfig
from pack_lockstep.blocks.settings import lockstep_config as blocks_config
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.packing.lockstep import Lockstep
from pack_lockstep.packing.lockstep_config import lockstep_config
from pack_lockstep.palletizing.benchmark import order_files, plan_order
from pack_lockstep.palletizing.lockstep import PalletLockstep
from pack_lockstep.palletizing.settings import set_up
from pack_motion.controller import MotionController
from pack_motion.setpoint_stream import StreamConfig
from pack_planner.rearrangement.instances import make_instance
from pack_sim.packing.scene_generator import generate_scene


class Output(StrEnum):
    """What the motion controller sends."""

    SETPOINTS = "setpoints"
    UNBOUNDED = "setpoints unbounded"
    TRAJECTORIES = "trajectories"


class Watched:
    """A follower, and by how much the joints are off what it asks for.

    Attributes:
        worst: largest error of a joint [rad].
    """

    def __init__(self, follower: Any) -> None:
        self._follower, self.feed_forward = follower, follower.feed_forward
        self.worst, self._squares, self._count = 0.0, 0.0, 0

    @property
    def rms(self) -> float:
        """Of all joints and steps [rad]."""
        return float(np.sqrt(self._squares / max(self._count, 1)))

    def at(self, time: float, q: Array, v: Array) -> Desired:
        desired: Desired = self._follower.at(time, q, v)
        error = desired[0] - q
        self.worst = max(self.worst, float(np.abs(error).max()))
        self._squares, self._count = self._squares + float(error @ error), self._count + len(q)
        return desired

    @property
    def is_holding(self) -> bool:
        """Whether the simulator's own law shall hold the arm."""
        return bool(self._follower.is_holding)

    def accept(self, setpoints: Setpoints, time: float) -> None:
        self._follower.accept(setpoints, time)


@dataclass(frozen=True)
class Trial:
    """How one problem or order went.

    Attributes:
        succeeded: parts that are where they should be.
        of: parts in all.
        duration: simulated [s].
        error_mm: largest of a part's place.
        tracking_mrad: largest error of a joint from what was asked of it.
        rms_mrad: the same, root mean square.
        force: the largest on what is held [N]; 0 where nothing measures it.
        sent: trajectories.
        trouble: what ended trajectories early.
    """

    succeeded: int
    of: int
    duration: float
    error_mm: float
    tracking_mrad: float
    rms_mrad: float
    force: float
    sent: int
    trouble: str


def prepared(
    motion: MotionController, simulator: Any, output: Output, cell: str, velocity: Array
) -> tuple[Watched, Any]:
    """Have a cell in lockstep driven as wanted; the follower, and the arm if trajectories drive it."""
    arm = None
    if output is Output.TRAJECTORIES:
        parameters = load_parameters(f"{cell}/motion", OutputParameters)
        arm = trajectory_driven(motion, simulator, StreamConfig(**parameters.model_dump()), velocity)
    watched = simulator.follower = Watched(simulator.follower)
    return watched, arm


class OutputParameters(Config):
    """The part of the motion node's parameters that is the stream's."""

    period: float
    horizon: float
    deviation: float


def run_blocks(seed: int, output: Output) -> Trial:
    """A problem of four blocks."""
    cell, made = blocks_cell(), []

    class Driven(BlocksLockstep):
        def __init__(self, *args: Any, **kwargs: Any) -> None:
            super().__init__(*args, **kwargs)
            made.append(prepared(self.motion, self.simulator, output, "blocks", ur10e.LIMITS.velocity))
            self._arm = made[0][1] or self._arm

    problem = make_instance(4, 0.2, seed, centre=cell.workspace.centre)
    execution.BlocksLockstep = Driven  # type: ignore[misc]
    done = execution.execute(problem, cell, CountedPlannerConfig(), blocks_config())
    return trial(int(done.is_ok), 1, done.duration_s, done.error_mm, *made[0])


def run_order(number: int, output: Output) -> Trial:
    """An order of config/orders, from the first on, with seed 0."""
    order, setup = load_order(order_files(config_path("orders"))[number]), set_up()
    plan = plan_order(order, setup.layout)
    lockstep = PalletLockstep(setup.cell, order, plan, setup.config, 0)
    stepped = lockstep.stepped
    driven = prepared(stepped.motion, stepped.simulator, output, "palletizing", kr210.LIMITS.velocity)
    stepped.arm = driven[1] or stepped.arm
    done = measure_order(lockstep.run())
    error = max((box.error_mm for box in done.boxes if box.error_mm is not None), default=np.inf)
    return trial(done.reward, done.reward + done.penalty, lockstep.simulator.time, error, *driven)


def run_scene(seed: int, output: Output) -> Trial:
    """A packing scene; its error is the distance from the packing pose."""
    cell, config = packing_cell(), lockstep_config()
    if output is Output.UNBOUNDED:
        nothing = config.simulator.governor.model_copy(update={"trigger": np.inf})
        config = config.model_copy(
            update={"simulator": config.simulator.model_copy(update={"governor": nothing})}
        )
    lockstep = Lockstep(cell, generate_scene(seed, cell), config, PackingMethod.PACK_IT_IN, seed)
    arm = relay_driven(lockstep.simulator) if output is Output.TRAJECTORIES else None
    watched = lockstep.simulator.follower = Watched(lockstep.simulator.follower)
    done = lockstep.run()
    return trial(
        int(done.success), 1, done.execution_time, 1e3 * done.distance, watched, arm, done.force_peak
    )


def trial(
    ok: int, of: int, duration: float, error_mm: float, watched: Watched, arm: Any, force: float = 0.0
) -> Trial:
    """The measures of one run."""
    sent, trouble = (0, "") if arm is None else (arm.sent, "; ".join(arm.trouble))
    return Trial(ok, of, duration, error_mm, 1e3 * watched.worst, 1e3 * watched.rms, force, sent, trouble)


RUNS = {"blocks": run_blocks, "palletizing": run_order, "packing": run_scene}
BOTH = (Output.SETPOINTS, Output.TRAJECTORIES)
OUTPUTS = {"blocks": BOTH, "palletizing": BOTH, "packing": tuple(Output)}


def main(cell: str, first: int = 0, number: int = 20) -> None:
    """Print all ways side by side."""
    columns = (
        "problem",
        "output",
        "ok",
        "of",
        "duration [s]",
        "error [mm]",
        "off [mrad]",
        "rms [mrad]",
        "force [N]",
        "sent",
    )
    table, console = Table(*columns, title=cell), Console(width=150)
    trials: dict[Output, list[Trial]] = {output: [] for output in OUTPUTS[cell]}
    for seed in range(first, first + number):
        for output in OUTPUTS[cell]:
            done = RUNS[cell](seed, output)
            trials[output].append(done)
            table.add_row(*row(str(seed), output, [done]))
            console.print(seed, output, done)
            console.file.flush()
    for output, runs in trials.items():
        table.add_row(*row("all", output, runs))
    console.print(table)


def row(name: str, output: Output, runs: list[Trial]) -> list[str]:
    """Of one run or several: sums of counts, the mean duration, the largest errors, the mean of the rms."""
    return [
        name, output, str(sum(r.succeeded for r in runs)), str(sum(r.of for r in runs)),
        f"{np.mean([r.duration for r in runs]):.2f}", f"{max(r.error_mm for r in runs):.2f}",
        f"{max(r.tracking_mrad for r in runs):.3f}", f"{np.mean([r.rms_mrad for r in runs]):.4f}",
        f"{max(r.force for r in runs):.1f}",
        str(sum(r.sent for r in runs)),
    ]  # fmt: skip


if __name__ == "__main__":
    typer.run(main)
