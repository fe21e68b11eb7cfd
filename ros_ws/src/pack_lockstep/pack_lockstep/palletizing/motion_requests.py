"""What the palletizing cell asks its arm for: requests for `pack benchmark motion`."""

from __future__ import annotations

from pack_core.motion.target import MotionTarget
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_lockstep.motion.requests import MotionRequest
from pack_lockstep.palletizing.lockstep import PalletLockstep
from pack_lockstep.palletizing.settings import set_up
from pack_motion.reference.trajectory import JointState
from pack_planner.layout.layout_planner import LayoutPlanner

CELL = "palletizing"
ORDERS = ("order_03", "order_09", "order_16")
SEEDS = range(4)
"""Each order is built with these seeds, with noise in place of pictures."""


def record() -> list[MotionRequest]:
    """Every target of the arm while the orders are built in lockstep."""
    found: list[MotionRequest] = []
    setup = set_up(vision=False)
    for seed in SEEDS:
        for name in ORDERS:
            order = load_order(config_path("orders", f"{name}.json"), setup.cell)
            plan = LayoutPlanner(setup.layout).plan(order)
            label = f"{name}_seed{seed}"

            def on_target(start: JointState, target: MotionTarget, label: str = label) -> None:
                found.append(MotionRequest(f"{label}_{target.id}", CELL, start, target))

            PalletLockstep(setup.cell, order, plan, setup.config, seed).run(on_target=on_target)
    return found
