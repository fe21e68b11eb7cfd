"""Orders from start to end in the cell without physics, and how far off their boxes end."""

from dataclasses import replace

import numpy as np

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.layout_plan import Insertion, LayoutPlan, LayoutStatus, PlannedBox
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.rotations import angle_between
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import FeederConfig, PalletizerConfig, ScanConfig
from unit.pallet_fsm.fake_cell import FakeCell
from unit.pallet_fsm.faults import Faults

NO_SCANS = ScanConfig(period=0.0)
"""Most tests do without scans, which take most of the time here."""


def given_order(number: int) -> Order:
    return load_order(config_path("orders", f"order_{number:02}.json"))


def plan_as_given(order: Order) -> LayoutPlan:
    straight = Insertion("Center", np.zeros(3), 0.0)
    boxes = tuple(PlannedBox(item, straight) for item in order.placed)
    return LayoutPlan(LayoutStatus.SUCCESS, "", boxes, 0.0, 0.0)


def run(
    order: Order,
    profile: str = "blended",
    faults: Faults | None = None,
    delay: float = 0.0,
    exposure: float = 0.0,
    linger: float = 1.0,
) -> tuple[Palletizer, FakeCell]:
    """An order from start to end.

    Args:
        order: what is built.
        profile: of the machine.
        faults: what shall go wrong.
        delay: how old a status of the motion is when it is observed [s].
        exposure: how long the camera takes [s].
        linger: how long the arm stays for the next box [s].
    """
    cell = FakeCell(order, faults or Faults(), exposure=exposure)
    config = PalletizerConfig(profile=profile, scans=NO_SCANS, feeder=FeederConfig(linger=linger))
    machine = Palletizer(
        OrderBook.of_order(order, plan_as_given(order), palletizing_cell()), palletizing_cell(), config, 0.0
    )
    while not machine.machine.is_over:
        seen = cell.observe()
        motion = replace(seen.motion, time=seen.motion.time - delay)
        for command in machine.step(replace(seen, motion=motion)):
            cell.apply(command)
        assert cell.time < 600.0, machine.machine.visits[-5:]
    return machine, cell


def misplacement(cell: FakeCell, report) -> tuple[float, float]:
    """Largest distance [m] and angle [rad] of any placed box from where it was meant to stand."""
    errors = [
        (
            float(np.linalg.norm(cell.boxes[box.name].p - box.X_WB.p)),
            float(angle_between(cell.boxes[box.name].q, box.X_WB.q)),
        )
        for box in report.boxes
        if box.outcome == "placed"
    ]
    return max(e[0] for e in errors), max(e[1] for e in errors)
