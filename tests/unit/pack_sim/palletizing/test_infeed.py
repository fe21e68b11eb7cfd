"""The simulated conveyor: boxes come one by one to the barrier, however close together they were laid."""

import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_sim.palletizing.infeed import ArrivingBox
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig

CELL = palletizing_cell("shift")
PLACES = CELL.shift.model_copy(update={"infeed": CELL.shift.infeed.model_copy(update={"length": 1.6})})
SHORT = CELL.model_copy(update={"shift": PLACES})
"""With a shorter belt for the queue, so that boxes come sooner."""
FRONT = CELL.picking_table.centre[0] - 0.5 * CELL.picking_table.size[0] + CELL.shift.infeed.barrier
SEAM = CELL.picking_table.centre[0] + 0.5 * CELL.picking_table.size[0]


@pytest.fixture(scope="module")
def stops() -> list[tuple[PalletSimulator, str, str, dict[str, np.ndarray]]]:
    """Three boxes that nearly touch, taken away one by one: what the conveyor told, and where they were."""
    boxes = [
        ArrivingBox(BoxBody(f"b{n}", (0.4, 0.3, 0.2), 6.0), f"label {n}", 0.1 * (n - 1), 0.02, 0.01)
        for n in range(3)
    ]
    simulator, found = PalletSimulator(SHORT, PalletSimulatorConfig(), arrivals=boxes), []
    for n in range(3):
        simulator.send_box()
        while simulator.infeed.number == n:
            simulator.step()
            assert simulator.time < 30.0
        for _ in range(250):
            simulator.step()
        truth = simulator.truth().objects
        where = {name: np.array([*state.X_WO.p[:2], state.v_WO_W[0]]) for name, state in truth.items()}
        found.append((simulator, simulator.infeed.box, simulator.infeed.label, where))
        simulator.remove(simulator.infeed.box)
    return found


def test_boxes_come_in_order_each_with_its_label(stops) -> None:
    assert [(box, label) for _, box, label, _ in stops] == [(f"b{n}", f"label {n}") for n in range(3)]


def test_a_box_rests_behind_the_barrier_alone_on_its_belt(stops) -> None:
    for _, box, _, where in stops:
        x, _, speed = where[box]
        assert FRONT - 0.1 < x - 0.2 < FRONT
        assert abs(speed) < 1e-3
        assert all(other[0] - 0.2 > SEAM - 0.02 for name, other in where.items() if name != box)


def test_nothing_comes_before_it_is_sent_for() -> None:
    box = ArrivingBox(BoxBody("b", (0.4, 0.3, 0.2), 6.0), "", 0.0, 0.0, 0.0)
    simulator = PalletSimulator(SHORT, PalletSimulatorConfig(), arrivals=[box])
    while simulator.time < 6.0:
        simulator.step()
    assert simulator.infeed.number == 0
    assert simulator.truth().objects["b"].X_WO.p[0] - 0.2 > SEAM
