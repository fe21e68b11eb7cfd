import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.rotations import Pose
from pack_lockstep.palletizing.stack_hold import hold_shift_mm

CELL = palletizing_cell()


def on_the_deck(height: float, size: tuple[float, float, float]) -> dict[BoxBody, Pose]:
    pallet = CELL.pallet
    p = [pallet.corner[0] + 0.6, pallet.corner[1] + 0.4, pallet.deck_height + height + size[2] / 2]
    return {BoxBody("a", size, 8.0): Pose(np.array(p))}


def test_a_flat_box_holds_less_than_friction_and_slides_at_more() -> None:
    flat = on_the_deck(0.0, (0.4, 0.3, 0.2))
    friction = CELL.contact.friction
    assert hold_shift_mm(CELL, flat, 0.5 * friction) < 1.0
    assert hold_shift_mm(CELL, flat, 1.5 * friction) > 10.0


def test_a_slender_box_falls_though_it_does_not_slide() -> None:
    assert hold_shift_mm(CELL, on_the_deck(0.0, (0.1, 0.1, 0.9)), 0.3) > 100.0
