"""Boxes of the orders lifted one by one, as they should be and with a fault in the hand: who is found out.

`PYTHONPATH=tests:$PYTHONPATH python -m benchmarks.weighing --good 1000 --planted 200 --seed 900` lifts so
many boxes as they are, drawn from all orders, and so many with a fault: nearly empty, twice as heavy, or with
a gripper that loses it and does not notice. It prints what was found, how soon, and by how much weights were
off.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus, PlannedBox
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.paths import config_path
from pack_lockstep.palletizing.benchmark import order_files
from pack_lockstep.palletizing.disturbances import CHANGES, DOUBLE, EMPTY, SLIP, PalletSite
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import PalletSetup, set_up
from pallet_fsm.shift_floor import STRAIGHT_DOWN
from pallet_fsm.states import State

AS_IT_IS = "as it is"
DONE = {AS_IT_IS: State.DETECT, EMPTY: State.DETECT, DOUBLE: State.DETECT, SLIP: State.LIFT}
"""What is done, and in which state."""


class Weighed(Exception):
    """The box was weighed."""


@dataclass(frozen=True)
class Lift:
    """What became of one lift.

    Attributes:
        mass: what the order says that the box weighs [kg].
        is_named: whether the machine said that the load is wrong.
        delay: from the start of the lift until it was weighed [s].
        error: what was weighed less what truly hung there [kg].
    """

    mass: float
    is_named: bool
    delay: float
    error: float


def lift(setup: PalletSetup, order: Order, what: str, seed: int) -> Lift | None:
    """Lift the one box of an order with something done to it; None where it was not lifted."""
    box = order.boxes[0]
    extents = np.array(box.turn.extents)
    planned = PlannedBox(PlacedBox(box.id, np.array([0.4, 0.3, 0.0]), extents, box.weight), STRAIGHT_DOWN)
    plan = LayoutPlan(LayoutStatus.SUCCESS, "", (planned,), 0.0, 0.0)
    cell = PalletLockstep(setup.cell, order, plan, setup.config, seed)
    item, start, is_done, site = cell.palletizer.item, 0.0, False, PalletSite(cell, box.id)

    def watch(tick: Tick) -> None:
        nonlocal start, is_done
        if tick.state is DONE[what] and not is_done and what != AS_IT_IS:
            CHANGES[what](site)
        is_done |= tick.state is DONE[what]
        if tick.state is State.LIFT and not start:
            start = tick.time
        if item.weighed is not None:
            raise Weighed

    with contextlib.suppress(Weighed):
        cell.run(watch)
    if item.weighed is None:
        return None
    hangs = 0.0 if what == SLIP else site.body.mass
    is_named = cell.palletizer.machine.state is State.WRONG_WEIGHT
    return Lift(box.weight, is_named, cell.simulator.time - start, item.weighed - hangs)


def main(preset: str = "rigid", good: int = 1000, planted: int = 200, seed: int = 900) -> None:
    """Lift boxes and print the table."""
    setup = set_up(preset=preset, vision=False)
    orders = [load_order(path) for path in order_files(config_path("orders"))]
    everything = [(order, box) for order in orders for box in order.boxes]
    faults = [what for what in DONE if what != AS_IT_IS]
    done = [AS_IT_IS] * good + [faults[i % len(faults)] for i in range(planted)]
    drawn = np.random.default_rng(seed).integers(len(everything), size=len(done))
    lifts: dict[str, list[Lift]] = {what: [] for what in DONE}
    for number, (what, index) in enumerate(track(list(zip(done, drawn, strict=True)), "lifting")):
        order, box = everything[index]
        one = lift(setup, order.model_copy(update={"boxes": (box,)}), what, seed + number)
        if one is not None:
            lifts[what].append(one)
    table = Table("what is done", "lifted", "named", "of 2.5 kg or more", "delay, mean, longest [s]",
                  "error, mean, p95, largest [kg]", title=f"preset {preset}, seed {seed}")  # fmt: skip
    for what, found in lifts.items():
        if not found:
            continue
        heavy = [one for one in found if one.mass >= 2.5]
        delays = [one.delay for one in found]
        errors = np.abs([one.error for one in found])
        table.add_row(
            what, str(len(found)), str(sum(one.is_named for one in found)),
            f"{sum(one.is_named for one in heavy)} of {len(heavy)}",
            f"{np.mean(delays):.2f}, {max(delays):.2f}",
            f"{errors.mean():.2f}, {np.percentile(errors, 95):.2f}, {errors.max():.2f}",
        )  # fmt: skip
    Console().print(table)


if __name__ == "__main__":
    typer.run(main)
