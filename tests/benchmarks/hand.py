"""Packing goals begun with what is described in the hand, and with a fault: who is found out, and when.

`PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.hand --preset ideal --scenes 10 --seed 0` begins the
goals of so many scenes, each with every fault, and follows them until the object goes in. It prints what was
named, how soon after the fault or the goal's start, and what was named without one.

With `--drawn 1000` only the motion of each goal is simulated. The wrench that belongs to it is worked out for
so many objects as described, within a quarter, and a fifth as many with each fault; `--bias` is the standard
deviation of the sensor's bias [N], which is set to zero when the object is gripped.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from pack_core.joints import JointSample
from pack_core.kinematics.chain import SerialChain
from pack_core.packing.goals import PackingMethod
from pack_core.packing.scene import Scene
from pack_core.packing.topics import WRENCH_RATE
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_core.topics import steps_between
from pack_lockstep.packing.lockstep import Lockstep, Step
from pack_lockstep.packing.settings import BenchmarkSettings, PackingSetup, set_up
from pack_mpc.held_watch import HeldWatch, arm_chain
from pack_mpc.load_estimate import BIAS_TIME, GRAVITY, LoadConfig
from pack_mpc.observation import PackingObservation
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator

LATEST = 0.4
"""The latest time after a goal's start at which an object is lost [s]."""
SPREAD = 0.25
"""By how much a drawn mass may differ from the described one, as a share."""
WHITE = 0.3
"""White noise of a drawn force [N]."""
AS_IT_IS, LOST = "as it is", "lost on the way"
FAULTS = {AS_IT_IS: 1.0, "nearly empty": 0.2, "twice as heavy": 2.0, "nothing gripped": 1e-3, LOST: 1e-3}
"""What is done, and what then hangs from the cup, as a share of the described mass."""


class Ended(Exception):
    """What was to be seen was seen."""


@dataclass
class Watched:
    """What became of one goal.

    Attributes:
        named: what was said of the load; empty: nothing.
        delay: from the fault, or the goal's start, to that [s].
        seconds: for how long the hand was watched [s].
    """

    named: str = ""
    delay: float = np.nan
    seconds: float = 0.0


@dataclass
class Motion:
    """How an arm moved from a goal's start until the object went in.

    Attributes:
        arm: with its cup.
        scene: as described.
        state: where its objects stood.
        samples: of the joints, at the rate of the wrench.
        looks: numbers of samples up to each cycle of the controller.
    """

    arm: SerialChain
    scene: Scene
    state: SceneState
    samples: list[JointSample] = field(default_factory=list)
    looks: list[int] = field(default_factory=list)


def weigh(simulator: Simulator, times: float) -> None:
    """Have what is held weigh so many times as much; cameras go on seeing it."""
    body = simulator.model.body(simulator.scene.new_object.name)
    body.mass[:] *= times
    body.inertia[:] *= times


def begin(setup: PackingSetup, seed: int, on_sample: Callable[[Lockstep], None]) -> Lockstep:
    """The goal of a scene, in which `on_sample` is called before every step of the physics."""
    lockstep = Lockstep(
        setup.cell, generate_scene(seed, setup.cell), setup.config, PackingMethod.PACK_IT_IN, seed
    )
    step = lockstep.simulator.step

    def observed() -> None:
        on_sample(lockstep)
        step()

    lockstep.simulator.step = observed  # type: ignore[method-assign]
    return lockstep


def is_over(step: Step) -> bool:
    """Whether the object is in; while it goes in, the watch itself knows when there may be contact."""
    return step.stage == "FINE_TUNE"


def follow(setup: PackingSetup, seed: int, what: str) -> Watched:
    """Begin the goal of a scene with something done to what is held."""
    found, is_planted = Watched(), False
    late = np.random.default_rng(seed).uniform(0.0, LATEST) if what == LOST else 0.0

    def on_sample(lockstep: Lockstep) -> None:
        nonlocal is_planted
        if not is_planted and lockstep.simulator.time >= start + late:
            is_planted = True
            weigh(lockstep.simulator, FAULTS[what])

    lockstep = begin(setup, seed, on_sample)
    start = lockstep.simulator.time

    def look(step: Step) -> None:
        if is_over(step):
            raise Ended
        found.seconds = step.time - start
        if (outcome := lockstep.session.task.outcome) is not None:
            found.named, found.delay = outcome.message, found.seconds - late

    with suppress(Ended):
        lockstep.run(look)
    return found


def record(setup: PackingSetup, seed: int) -> Motion:
    """The motion of a goal."""
    every, count, samples = steps_between(WRENCH_RATE, setup.config.simulator.timestep), 0, []

    def on_sample(lockstep: Lockstep) -> None:
        nonlocal count
        count += 1
        if count % every == 0:
            samples.append(lockstep.simulator.joints())

    lockstep, arm = begin(setup, seed, on_sample), arm_chain(setup.cell)
    motion: Motion | None = None

    def look(step: Step) -> None:
        nonlocal motion
        motion = motion or Motion(arm, lockstep.session.scene, step.seen.scene, samples)
        if is_over(step):
            raise Ended
        motion.looks.append(len(samples))

    with suppress(Ended):
        lockstep.run(look)
    assert motion is not None
    return motion


def drawn(motion: Motion, what: str, bias: float, config: LoadConfig, rng: np.random.Generator) -> Watched:
    """Watch a motion with the wrench of a drawn object and a drawn sensor."""
    watch, item = HeldWatch(motion.arm, motion.scene, config), motion.scene.new_object
    period, found = 1.0 / WRENCH_RATE, Watched()
    late = rng.uniform(0.0, LATEST) if what == LOST else 0.0
    right = item.mass * rng.uniform(1.0 - SPREAD, 1.0 + SPREAD)
    memory, b = np.exp(-period / BIAS_TIME), bias * rng.normal(size=3)
    zero = b
    first, before, forces = 0, None, list[Array]()
    start = motion.samples[0].time
    for last in motion.looks:
        for sample in motion.samples[first:last]:
            R, v = watch.motion(sample)
            b = memory * b + np.sqrt(1.0 - memory**2) * bias * rng.normal(size=3)
            mass = right if sample.time < start + late else right * FAULTS[what]
            a = np.zeros(3) if before is None else (v - before) / period
            before = v
            force = R.T @ (item.mass * GRAVITY - mass * (a + GRAVITY)) + b - zero + WHITE * rng.normal(size=3)
            forces.append(force)
        if last > first:
            found.seconds = motion.samples[last - 1].time - start
            newest = motion.samples[last - 1]
            fault = watch.observe(
                PackingObservation(newest, motion.state, np.array(forces), zeroed=start - period)
            )
            forces.clear()
            first = last
            if fault is not None:
                found.named, found.delay = fault.message, found.seconds - late
                break
    return found


def main(preset: str = "ideal", scenes: int = 10, seed: int = 0, drawn_of: int = typer.Option(0, "--drawn"),
         bias: float = 0.0) -> None:  # fmt: skip
    """Begin goals and print the table."""
    setup, config = set_up(BenchmarkSettings(preset=preset), threads=1), LoadConfig()
    done: dict[str, list[Watched]] = {what: [] for what in FAULTS}
    if drawn_of:
        motions = [record(setup, number) for number in track(range(seed, seed + scenes), "packing")]
        rng = np.random.default_rng(seed)
        for what, found in done.items():
            count = drawn_of if what == AS_IT_IS else drawn_of // 5
            found += [drawn(motions[i % scenes], what, bias, config, rng) for i in track(range(count), what)]
    else:
        for number in track(range(seed, seed + scenes), "packing"):
            for what, found in done.items():
                found.append(follow(setup, number, what))
    table = Table("what is done", "goals", "named", "within 0.5 s", "delay, mean, longest [s]",
                  "watched, mean [s]", title=f"preset {preset}, {scenes} scenes from seed {seed}, "
                  + (f"drawn, bias {bias} N" if drawn_of else "simulated"))  # fmt: skip
    for what, found in done.items():
        named = [one for one in found if one.named]
        delays = np.array([one.delay for one in named] or [np.nan])
        table.add_row(
            what, str(len(found)), str(len(named)), str(int((delays <= 0.5).sum())),
            f"{delays.mean():.2f}, {delays.max():.2f}", f"{np.mean([one.seconds for one in found]):.2f}",
        )  # fmt: skip
    Console(width=110).print(table)


if __name__ == "__main__":
    typer.run(main)
