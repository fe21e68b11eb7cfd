"""Boxes on a shift's conveyor measured, judged and taken away: which faults are found, and which are none.

`PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.rejects --planted 200 --good 1000 --seed 1200` runs the
simulated conveyor until so many faulty boxes and so many others were judged. The arm stands beside it. It
prints, by kind of fault, how many were set aside and why, and how far measured sizes are from the true ones.
"""

from __future__ import annotations

from collections import Counter, defaultdict

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from pack_core.errors import PackError
from pack_core.palletizing.ports import DiscardBox
from pack_lockstep.palletizing.shift import stream_of
from pack_lockstep.palletizing.shift_lockstep import shift_run_setup
from pack_lockstep.palletizing.stepped_cell import SteppedCell
from pack_sim.palletizing.arrivals import ArrivalConfig, Arrivals
from pallet_fsm.intake import Arrival, Intake

SHARE = 1 / 6
"""Of the boxes that are faulty."""


def judged(cell: SteppedCell, intake: Intake) -> Arrival:
    """The next box, once it was measured at the barrier.

    Raises:
        PackError: there will be no more boxes.
    """
    cell.apply(intake.send())
    while intake.arrival is None:
        for command in intake.step(cell.observe(), None):
            cell.apply(command)
        cell.advance()
        if intake.reason:
            raise PackError(intake.reason)
    return intake.arrival


def main(planted: int = 200, good: int = 1000, seed: int = 1200) -> None:
    """Judge boxes and print the table."""
    setup = shift_run_setup(arrivals=ArrivalConfig(faulty=SHARE))
    stream = setup.stream
    arrivals = Arrivals(stream.items, stream_of(stream, seed), setup.arrivals, seed)
    rng = np.random.default_rng(seed)
    cell = SteppedCell(
        stream.cell, stream.cell, setup.config, seed, rng, lambda reason: None, arrivals=arrivals
    )
    intake = Intake(stream.cell, {item.id: item for item in stream.items}, setup.shift.intake)
    came, aside = Counter[str](), Counter[str]()
    doubts: dict[str, Counter[str]] = defaultdict(Counter)
    errors: list[np.ndarray] = []
    while came[""] < good or came.total() - came[""] < planted:
        arrival = judged(cell, intake)
        body = next(box for box in cell.simulator.boxes if box.name == arrival.box)
        fault = arrivals.faults.get(arrival.box, "")
        is_enough = came[""] >= good if fault == "" else came.total() - came[""] >= planted
        if not is_enough:
            came[fault] += 1
            if arrival.item is None:
                aside[fault] += 1
                doubts[fault]["".join(c for c in arrival.doubt if not c.isdigit())] += 1
            if not fault:
                errors.append(np.abs(arrival.dims - 2.0 * np.array(body.half_extents)))
        cell.apply(DiscardBox(arrival.box))
        intake.clear()
    table = Table("what is wrong", "came", "set aside", "most often, because", title=f"seed {seed}")
    for fault, count in came.most_common():
        why = "; ".join(text for text, _ in doubts[fault].most_common(2))
        table.add_row(fault or "nothing", str(count), str(aside[fault]), why)
    Console().print(table)
    worst = 1e3 * np.array(errors).max(axis=1)
    typer.echo(
        f"faulty: {came.total() - came['']}, set aside {aside.total() - aside['']}; "
        f"good: {came['']}, set aside {aside['']}; {cell.simulator.time:.0f} s simulated\n"
        f"largest error of an edge, p95 {np.percentile(worst, 95):.1f} mm, largest {worst.max():.1f} mm"
    )


if __name__ == "__main__":
    typer.run(main)
