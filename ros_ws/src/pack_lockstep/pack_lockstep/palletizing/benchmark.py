"""Many orders of the palletizing cell in lockstep: run, kept line by line, read back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from pack_core.errors import ConfigError, OrderError, PackError
from pack_core.palletizing.box_body import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.palletizing.summary import OrderTrial
from pack_lockstep.benchmarking.pools import Pool
from pack_lockstep.benchmarking.trial_file import TrialFile, read_trials
from pack_lockstep.palletizing.lockstep import PalletLockstep, PalletLockstepConfig
from pack_lockstep.palletizing.stack_hold import hold_shift_mm
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner


@dataclass(frozen=True)
class Setup:
    """What decides the results, orders and seeds apart."""

    cell: PalletizingCell
    config: PalletLockstepConfig
    layout: LayoutConfig

    def record(self) -> dict[str, Any]:
        """All of it as plain values, for the head of the results."""
        parts = {"cell": self.cell, "config": self.config, "layout": self.layout}
        return {name: part.model_dump(mode="json") for name, part in parts.items()}


@dataclass(frozen=True)
class OrderJob:
    """An order file to run with a seed."""

    path: Path
    seed: int

    @property
    def name(self) -> str:
        """Of the trial."""
        return f"{self.path.stem}_seed{self.seed}"


def order_jobs(folder: Path, seeds: int, cell: PalletizingCell) -> list[OrderJob]:
    """Every order of a folder with the seeds from 0 on, the first seed of all orders first.

    Raises:
        ConfigError: there is no order file.
        OrderError: the cell cannot build some; the text says why for each of them.
    """
    files = sorted(folder.glob("*.json"))
    if not files:
        raise ConfigError(f"{folder} has no order files (*.json); config/orders has 25")
    if refusals := [refusal for path in files if (refusal := _refusal(path, cell))]:
        raise OrderError("\n".join(refusals))
    return [OrderJob(path, seed) for seed in range(seeds) for path in files]


def _refusal(path: Path, cell: PalletizingCell) -> str:
    try:
        load_order(path, cell)
    except OrderError as error:
        return str(error)
    return ""


def run_order(setup: Setup, job: OrderJob) -> dict[str, Any]:
    """Plan and build an order; a line of the results."""
    order = load_order(job.path)
    plan = plan_order(order, setup.layout)
    lockstep = PalletLockstep(setup.cell, order, plan, setup.config, job.seed)
    run = lockstep.run()
    placed = stack(order, run)
    hold_mm = hold_shift_mm(setup.cell, placed) if placed else None
    measures = asdict(measure_order(run))
    return {
        "name": job.name, "order": job.path.stem, "seed": job.seed, "reason": run.reason,
        "measures": measures, "hold_mm": hold_mm,
    }  # fmt: skip


def plan_order(order: Order, config: LayoutConfig) -> LayoutPlan:
    """The layout; raises PackError where there is none."""
    plan = LayoutPlanner(config).plan(order)
    if plan.status is not LayoutStatus.SUCCESS:
        raise PackError(f"order {order.order_id}: {plan.reason}")
    return plan


def stack(order: Order, run: PalletRun) -> dict[BoxBody, Any]:
    """The boxes that were placed, where they stand at the end."""
    placed = [box.name for box in run.boxes if box.outcome == "placed"]
    bodies = {name: order.box(name) for name in placed}
    return {
        BoxBody(name, box.dims, box.weight): run.tracks[name].at(float("inf")) for name, box in bodies.items()
    }


def run_orders(path: Path, setup: Setup, jobs: Sequence[OrderJob], pool: Pool) -> Iterator[OrderTrial]:
    """Run what the file does not have yet, and keep each when it is done.

    Raises:
        PackError: the file is of other settings, or an order cannot be planned.
    """
    file = TrialFile(path, setup.record())
    missing = [job for job in jobs if job.name not in file.trials]
    for line in pool.run(partial(run_order, setup), missing):
        file.add(line)
        yield trial_of(line)


def kept_trials(path: Path, jobs: Sequence[OrderJob]) -> list[OrderTrial]:
    """Those of the jobs that the file has."""
    names = {job.name for job in jobs}
    return [trial_of(line) for name, line in read_trials(path)[1].items() if name in names]


def trial_of(line: Mapping[str, Any]) -> OrderTrial:
    """A trial from its line."""
    return OrderTrial(line["order"], line["seed"], line["measures"], line["hold_mm"])
