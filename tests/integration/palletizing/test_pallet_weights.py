"""The check of an order's weights against the gripper, in physics: what it lets pass is carried."""

import json
from pathlib import Path

import pytest

from pack_core.errors import OrderError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_evaluation.palletizing.measures import OrderMeasures, measure_order
from pack_lockstep.palletizing.benchmark import plan_order
from pack_lockstep.palletizing.lockstep import PalletLockstep
from pack_lockstep.palletizing.settings import set_up

pytestmark = pytest.mark.timeout(300)
CELL = palletizing_cell()
LYING, STOOD_UP = 0, 5
"""orient_id, with the bundling axis z."""


def order_file(folder: Path, dims: tuple[float, float, float], weight: float, orient_id: int) -> Path:
    """An order of one box."""
    box = {"id": "a", "dims": dims, "weight": weight, "orient_id": orient_id, "bundling_axis": "z",
           "position": (0.4, 0.3, 0.0)}  # fmt: skip
    pallet = {"length": 1.2, "width": 0.8, "deck_height": 0.144}
    path = folder / "order.json"
    path.write_text(json.dumps({"order_id": "one box", "pallet": pallet, "boxes": [box]}))
    return path


def built(order: Order) -> OrderMeasures:
    """What becomes of it, whatever the check says."""
    setup = set_up(vision=False)
    plan = plan_order(order, setup.layout)
    return measure_order(PalletLockstep(setup.cell, order, plan, setup.config, seed=0).run())


@pytest.mark.parametrize(
    ("dims", "weight", "orient_id"),
    [((0.4, 0.4, 0.4), 18.7, LYING), ((0.4, 0.3, 0.25), 13.4, STOOD_UP)],
    ids=["deep", "stood up"],
)
def test_the_heaviest_boxes_that_pass_are_carried_within_all_limits(
    tmp_path: Path, dims: tuple[float, float, float], weight: float, orient_id: int
) -> None:
    with pytest.raises(OrderError, match="make a moment"):
        load_order(order_file(tmp_path, dims, 1.02 * weight, orient_id), CELL)
    measures = built(load_order(order_file(tmp_path, dims, weight, orient_id), CELL))
    assert measures.is_complete
    (box,), limits = measures.boxes, CELL.grip
    assert box.coaxial_N is not None
    assert box.shear_N is not None
    assert box.moment_Nm is not None
    assert 0.4 * limits.coaxial_force < box.coaxial_N < limits.coaxial_force
    assert 0.4 * limits.shear_force < box.shear_N < limits.shear_force
    assert 0.4 * limits.moment < box.moment_Nm < limits.moment


def test_a_box_far_beyond_the_check_would_be_lost(tmp_path: Path) -> None:
    path = order_file(tmp_path, (0.4, 0.3, 0.2), 33.0, LYING)
    with pytest.raises(OrderError, match="make a coaxial force of 587"):
        load_order(path, CELL)
    measures = built(load_order(path))
    assert measures.drops == 1
    assert "coaxial force" in measures.faults[0]
