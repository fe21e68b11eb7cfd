"""Shifts gone on with from moments drawn by chance: what is found of what stands, and what is touched.

`PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.restarts DIR/journal.db --times 20 --seed 1` takes the
journal of a shift that `pack demo palletizing --shift` has run. What was on the disk at some moment is what a
kill leaves. From there, each time,

1. the simulated cell is filled as the journal says, one uncovered box of each pallet is pushed and turned a
   little, and everything is taken over by scans: how far from the truth is each pushed box taken to stand?
2. the shift goes on with more boxes: do they come to stand, and is anything touched or dropped?
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import typer

from pack_core.errors import PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import REORIENTATION_TABLE
from pack_core.palletizing.shift_journal import SETTLED, EventKind, ShiftEvent, read_journal
from pack_core.rotations import Pose, from_yaw, multiply
from pack_lockstep.palletizing.shift_lockstep import ShiftLockstep, ShiftRunSetup, shift_run_setup
from pallet_fsm.order_book import WorkItem
from pallet_fsm.taking_over import standing_by_journal, take_over

PUSH = (0.006, 0.028)
"""Least and largest way that a box is pushed [m]: from 5 mm on along an edge a box counts as moved, and up to
30 mm its pallet is gone on with."""
TURN_DEG = 1.5
"""By which a box is turned at most, either way."""
ATTEMPTS = 50
"""Pushes that are tried until one leads where nothing stands."""


@dataclass
class Found:
    """What came of all restarts.

    Attributes:
        standing: boxes that stood, by restart.
        errors: of each pushed box that was noticed, how far it is taken to stand from the truth [m].
        turn_errors: the same of its turn [deg].
        unnoticed: ways of the pushed boxes that were taken for where the journal has them [m].
        others: what was in doubt of boxes that nobody pushed.
        settled: boxes that were dealt with after going on.
        wrong: contacts, falls, lost boxes, and ends before all had come.
    """

    standing: list[int] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    turn_errors: list[float] = field(default_factory=list)
    unnoticed: list[float] = field(default_factory=list)
    others: list[str] = field(default_factory=list)
    settled: int = 0
    wrong: list[str] = field(default_factory=list)


def body_of(work: WorkItem) -> BoxBody:
    """The box as the simulator takes it."""
    return BoxBody(work.name, work.box.dims, work.box.weight)


def pushed(lockstep: ShiftLockstep, work: WorkItem, rng: np.random.Generator) -> Pose | None:
    """Put a box a little beside its place, X_WB; None if something stands wherever it was tried."""
    assert work.X_WB is not None
    body = body_of(work)
    for _ in range(ATTEMPTS):
        way, heading = rng.uniform(*PUSH), rng.uniform(0.0, 2.0 * np.pi)
        turn = from_yaw(np.deg2rad(rng.uniform(-TURN_DEG, TURN_DEG)))
        shift = way * np.array([np.cos(heading), np.sin(heading), 0.0])
        X_WB = Pose(work.X_WB.p + shift, multiply(turn, work.X_WB.q))
        try:
            return lockstep.stepped.simulator.spawn(body, X_WB)
        except PackError:
            continue
    lockstep.stepped.simulator.spawn(body, work.X_WB)
    return None


def look(setup: ShiftRunSetup, before: Sequence[ShiftEvent], rng: np.random.Generator, found: Found) -> None:
    """Push a box of each pallet, and take over what stands."""
    cell = setup.stream.cell
    lockstep = ShiftLockstep(setup, 1, int(rng.integers(10**6)))
    standing = standing_by_journal(before)
    chosen: dict[str, WorkItem] = {}
    for pallet in cell.pallets:
        there = [work for work, _ in standing if work.deck == pallet]
        places = [work.plan.placed for work in there]
        free = [work for work in there if not any(box.is_over(work.plan.placed) for box in places)]
        if free:
            chosen[pallet] = free[int(rng.integers(len(free)))]
    names = {work.name for work in chosen.values()}
    for work, _ in standing:
        if work.name not in names:
            lockstep.stepped.simulator.spawn(body_of(work), work.X_WB)
    truth = {work.name: pushed(lockstep, work, rng) for work in chosen.values()}
    began = {work.name: work.X_WB for work in chosen.values()}
    scans = {place: lockstep.stepped.scan(place) for place in (*cell.pallets, REORIENTATION_TABLE)}
    over = take_over(standing, scans, cell, setup.config.palletizer.scans)
    moved = {work.name: work for work, _ in over.moved}
    found.standing.append(len(standing))
    for name, X_WB in truth.items():
        if X_WB is None:
            continue
        if name not in moved:
            found.unnoticed.append(float(np.linalg.norm(X_WB.p - began[name].p)))
            continue
        error = moved[name].X_WB.inverse() @ X_WB
        found.errors.append(float(np.linalg.norm(error.p)))
        found.turn_errors.append(float(np.rad2deg(2.0 * np.arcsin(min(1.0, np.linalg.norm(error.q[1:]))))))
    found.others += [doubt for doubt in over.doubts if not any(name in doubt for name in names)]


def go_on(setup: ShiftRunSetup, before: Sequence[ShiftEvent], seed: int, boxes: int, found: Found) -> None:
    """Run the shift from there until so many more boxes have come, and note what went wrong."""
    settled = {event.box for event in before if event.kind in SETTLED}
    run = ShiftLockstep(setup, len(settled) + boxes, seed, before).run()
    found.settled += len({event.box for event in run.events if event.kind in SETTLED})
    wrong = (EventKind.TOUCHED, EventKind.FELL, EventKind.LOST, EventKind.SKIPPED)
    found.wrong += [
        f"{event.box} {event.kind}: {event.reason}" for event in run.events if event.kind in wrong
    ]
    if run.reason != "all boxes came":
        found.wrong.append(f"ended: {run.reason}")


def main(journal: Path, times: int = 20, boxes: int = 2, seed: int = 1) -> None:
    """Go on so many times, each time with so many boxes, and print what was found."""
    written, setup = read_journal(journal), shift_run_setup()
    rng, found = np.random.default_rng(seed), Found()
    for number in range(1, times + 1):
        before = written.events[: int(rng.integers(1, len(written.events)))]
        lines = len(found.others), len(found.wrong)
        look(setup, before, rng, found)
        go_on(setup, before, written.facts["seed"], boxes, found)
        typer.echo(
            f"{number} of {times}: after {len(before)} events, {before[-1].time:.0f} s, "
            f"{found.standing[-1]} boxes stood"
        )
        for line in (*found.others[lines[0] :], *found.wrong[lines[1] :]):
            typer.echo(f"  {line}")
    typer.echo(
        f"boxes that stood: {min(found.standing)} to {max(found.standing)}, {sum(found.standing)} in all"
    )
    for name, errors, unit, scale in (
        ("place", found.errors, "mm", 1e3),
        ("turn", found.turn_errors, "deg", 1.0),
    ):
        if not errors:
            continue
        p95, largest = scale * np.percentile(errors, 95), scale * max(errors)
        typer.echo(
            f"{name} of {len(errors)} pushed boxes: p95 {p95:.2f} {unit}, largest {largest:.2f} {unit}"
        )
    ways = ", ".join(f"{1e3 * way:.1f}" for way in found.unnoticed)
    typer.echo(f"pushed and not noticed: {len(found.unnoticed)}" + (f" ({ways} mm)" if ways else ""))
    typer.echo(f"in doubt though nobody pushed them: {len(found.others)}")
    typer.echo(f"{found.settled} of {times * boxes} boxes were dealt with after going on")
    typer.echo(f"went wrong: {len(found.wrong)}")


if __name__ == "__main__":
    typer.run(main)
