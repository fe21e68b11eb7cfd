"""When arm and carried box are over a place, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.cell import PALLET, palletizing_cell
from pack_core.robots.kr210 import WRIST_LENGTH
from pack_core.rotations import POINTING_DOWN, Pose, exp
from pallet_fsm.place_watch import ArmShadow

CELL = palletizing_cell()
SHADOW = ArmShadow(next(block for block in CELL.furniture if block.name == PALLET), CELL)
BESIDE_Y = CELL.pallet.corner[1] + CELL.pallet.size[1]
"""Edge of the pallet that looks at table B, along y [m]."""


def at(x: float, y: float) -> Pose:
    return Pose(np.array([x, y, 1.5]), POINTING_DOWN)


def test_an_arm_over_the_pallet_has_no_clearance_and_one_beside_it_its_distance() -> None:
    assert SHADOW.clearance(at(0.0, 0.5), None) == 0.0
    assert SHADOW.clearance(at(-0.5, BESIDE_Y + 0.28), None) == pytest.approx(0.28, abs=0.01)


def test_an_arm_that_reaches_across_the_pallet_hides_it() -> None:
    assert SHADOW.clearance(at(0.9, 0.0), None) == 0.0


def test_a_carried_box_takes_half_its_diagonal() -> None:
    box = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), np.array([0.3, 0.4, 0.2]))
    assert SHADOW.clearance(at(-0.5, BESIDE_Y + 0.28), box) == pytest.approx(0.28 - 0.25, abs=0.01)
    assert SHADOW.clearance(at(0.0, 0.5), box) < 0.0


def test_a_tool_that_looks_away_from_the_pallet_has_its_wrist_nearer_to_it() -> None:
    away = Pose(np.array([-0.2, BESIDE_Y + 0.6, 1.5]), exp([-np.pi / 2, 0.0, 0.0]))
    assert away.apply(np.array([0.0, 0.0, 1.0]))[1] == pytest.approx(BESIDE_Y + 1.6)
    reach = CELL.tool.length + WRIST_LENGTH
    assert SHADOW.clearance(away, None) == pytest.approx(0.6 - reach, abs=0.01)
