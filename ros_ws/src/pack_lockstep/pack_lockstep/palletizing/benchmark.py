"""The benchmark of the palletizing cell: many orders, each built with many seeds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from pack_core.errors import ConfigError, OrderError, PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.calibration import CellCalibration, KnownCell
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_evaluation.palletizing.chapter_9 import chapter_9
from pack_evaluation.palletizing.measures import measure_order, measures_of_unbuilt
from pack_evaluation.palletizing.plots import visitors_picture
from pack_evaluation.palletizing.run import PalletRun
from pack_lockstep.benchmarking.benchmark import Benchmark, Verdict
from pack_lockstep.palletizing.lockstep import PalletLockstep
from pack_lockstep.palletizing.stack_hold import hold_shift_mm
from pack_lockstep.palletizing.stepped_cell import PalletLockstepConfig
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pack_sim.palletizing.crossings import visitors_of

FILES = "files"
"""Key of what a result has of files, by their paths, which are no part of the results."""


@dataclass(frozen=True)
class PalletSetup:
    """All settings that decide the results, besides orders and seeds."""

    name: str
    """Short name for tables: profile, motion, the arm's preset, and how boxes are detected."""
    cell: PalletizingCell
    config: PalletLockstepConfig
    layout: LayoutConfig
    visitors: str = ""
    """Who comes near the arm: a file of config/visitors, `random`, or nobody."""
    calibrations: Mapping[int, CellCalibration] = field(default_factory=dict)
    """By seed, of cells that are calibrated."""
    calibrated_by: str = ""
    """What the calibrations come from, in words; empty: there are none."""

    def record(self) -> dict[str, Any]:
        """All settings as plain values, for the head of the results."""
        parts = {"cell": self.cell, "config": self.config, "layout": self.layout}
        return {
            "name": self.name, **{name: part.model_dump(mode="json") for name, part in parts.items()},
            "visitors": self.visitors, "calibrated_by": self.calibrated_by,
        }  # fmt: skip


@dataclass(frozen=True)
class OrderJob:
    """An order file to run with a seed."""

    path: Path
    seed: int

    @property
    def name(self) -> str:
        """Name of the trial, unique in the benchmark."""
        return f"{self.path.stem}_seed{self.seed}"


def order_files(folder: Path) -> list[Path]:
    """The order files of a folder, by name.

    Raises:
        ConfigError: there is none.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder; config/orders is one")
    files = sorted(folder.glob("*.json"))
    if not files:
        raise ConfigError(f"{folder} has no order files (*.json); config/orders has 25")
    return files


def order_jobs(
    files: Sequence[Path], seeds: int, cell: PalletizingCell, first_seed: int = 0
) -> list[OrderJob]:
    """Every order file with so many seeds from `first_seed` on, the first seed of all orders first.

    Raises:
        ConfigError: a file does not exist, or is no order file, or two have one name.
        OrderError: the cell cannot build some of the orders; the text has the reasons for each of them.
    """
    if refusals := [refusal for path in files if (refusal := _refusal(path, cell))]:
        raise OrderError("\n".join(refusals))
    names = [path.stem for path in files]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(
            f"trials are kept by the names of files, and several are called {', '.join(twice)}; allowed: "
            "each name once"
        )
    return [OrderJob(path, seed) for seed in range(first_seed, first_seed + seeds) for path in files]


def _refusal(path: Path, cell: PalletizingCell) -> str:
    try:
        load_order(path, cell)
    except OrderError as error:
        return str(error)
    return ""


def run_order(setup: PalletSetup, job: OrderJob, *, has_plots: bool = False) -> dict[str, Any]:
    """Plan and build an order; the result is a line of the results file, as plain values.

    An order without a layout counts as not built.
    """
    order = load_order(job.path)
    plan, calibration = LayoutPlanner(setup.layout).plan(order), setup.calibrations.get(job.seed)
    if plan.status is not LayoutStatus.SUCCESS:
        unbuilt = asdict(measures_of_unbuilt(order, f"no layout: {plan.reason}"))
        return {
            "name": job.name, "order": job.path.stem, "seed": job.seed, "reason": plan.reason,
            "measures": unbuilt, "hold_mm": None,
        }  # fmt: skip
    KnownCell(setup.cell, calibration).check_gap(plan.gap)
    config = setup.config.model_copy(update={"visitors": visitors_of(setup.visitors, job.seed)})
    lockstep = PalletLockstep(setup.cell, order, plan, config, job.seed, calibration)
    run = lockstep.run()
    placed = stack(order, run)
    hold_mm = hold_shift_mm(lockstep.simulator.cell, placed) if placed else None
    measures = asdict(measure_order(run))
    predicted = {} if calibration is None else {"predicted_mm": calibration.predicted.model_dump()}
    return {
        "name": job.name, "order": job.path.stem, "seed": job.seed, "reason": run.reason,
        "measures": measures, "hold_mm": hold_mm, **predicted, FILES: _files(job, run, has_plots=has_plots),
    }  # fmt: skip


def _files(job: OrderJob, run: PalletRun, *, has_plots: bool) -> dict[str, bytes]:
    """The plot of a run's visitors, if there were any, and figures and trajectories if they are wanted."""
    picture = visitors_picture(run)
    files = {} if picture is None else {f"visitors/{job.name}.png": picture}
    if has_plots:
        files |= {f"plots/{job.name}/{name}": data for name, data in chapter_9(run).items()}
    return files


def plan_order(order: Order, config: LayoutConfig) -> LayoutPlan:
    """Plan the layout of an order; raises PackError where there is none."""
    plan = LayoutPlanner(config).plan(order)
    if plan.status is not LayoutStatus.SUCCESS:
        raise PackError(f"order {order.order_id}: {plan.reason}")
    return plan


def stack(order: Order, run: PalletRun) -> dict[BoxBody, Any]:
    """The boxes that were placed, with their true poses at the end of the run."""
    placed = [box.name for box in run.boxes if box.outcome == "placed"]
    bodies = {name: order.box(name) for name in placed}
    return {BoxBody(name, box.dims, box.weight): run.tracks[name].pose(-1) for name, box in bodies.items()}


@dataclass(frozen=True)
class PalletBenchmark(Benchmark[OrderJob, dict[str, Any]]):
    """A benchmark of orders with one setup."""

    cell: ClassVar[str] = "palletizing"
    files: ClassVar[tuple[str, ...]] = ("visitors/*.png", "plots/*/*")

    setup: PalletSetup
    jobs: tuple[OrderJob, ...]
    has_plots: bool = False
    """Whether figures and trajectories of every trial are kept beside the results."""

    @property
    def folder_name(self) -> str:
        """Name of the results folder: profile, motion, the arm's preset, and how boxes are detected."""
        return f"{self.cell}_{self.setup.name.replace(' ', '_')}"

    def settings(self) -> Mapping[str, Any]:
        """The cell's facts, and the parameters of all nodes and of the layout planner."""
        return self.setup.record()

    @property
    def work(self) -> Callable[[OrderJob], dict[str, Any]]:
        """The function that plans and builds an order."""
        return partial(run_order, self.setup, has_plots=self.has_plots)

    def keep(self, result: dict[str, Any], folder: Path) -> Mapping[str, Any]:
        """The measures of the trial; its files are written."""
        for name, data in result.get(FILES, {}).items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        return {key: value for key, value in result.items() if key != FILES}

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """One line: placed boxes, largest error, mean cycle time, tracking error, contacts and all faults."""
        m = trial["measures"]
        errors = [box["error_mm"] for box in m["boxes"] if box["error_mm"] is not None]
        cycles = [box["cycle_s"] for box in m["boxes"] if box["cycle_s"] is not None]
        text = (
            f"{m['reward']:2} of {len(m['boxes']):2} boxes  worst {max(errors, default=0.0):5.2f} mm  "
            f"cycle {sum(cycles) / max(len(cycles), 1):5.1f} s  tracking {m['position_mm'][1]:5.2f} mm  "
            f"{m['touches']} contacts"
        )
        name = f"{trial['order']} seed {trial['seed']}"
        return Verdict(name, m["is_complete"], "; ".join([text, *m["faults"]]))
