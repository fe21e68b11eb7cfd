"""What a hand can do to the boxes, the gripper and the camera of the palletizing cell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pack_core.errors import PackError
from pack_core.palletizing.box_body import BoxBody
from pack_core.rotations import Array, Pose, from_yaw, multiply
from pack_lockstep.palletizing.lockstep import PalletLockstep

TURN, SHIFT = np.deg2rad(20.0), np.array([0.06, 0.0, 0.0])
BESIDE = np.array([0.0, -0.4, 0.0])
"""From a box on table A to where another one is put beside it [m]."""
OTHER = (0.2, 0.15, 0.12)
"""Size of a box that does not belong to the order [m]."""


@dataclass
class PalletReach:
    """What a hand can reach: the cell, the box that is meant, and the state of the machine."""

    cell: PalletLockstep
    box: str

    @property
    def body(self) -> BoxBody:
        """The box as it is in the simulator."""
        return next(box for box in self.cell.simulator.boxes if box.name == self.box)

    @property
    def X_WB(self) -> Pose:
        """Where it truly is."""
        return self.cell.simulator.truth().objects[self.box].X_WO

    def move(self, X_WB: Pose) -> None:
        """Put the box somewhere else; raises PackError where there is no room, and leaves it where it was."""
        body, before, simulator = self.body, self.X_WB, self.cell.simulator
        simulator.remove(self.box)
        try:
            simulator.spawn(body, X_WB)
        except PackError:
            simulator.spawn(body, before)
            raise


PalletDeed = Callable[[PalletReach], None]


def _remove(reach: PalletReach) -> None:
    reach.cell.simulator.remove(reach.box)


def _turn(reach: PalletReach) -> None:
    X_WB = reach.X_WB
    reach.move(Pose(X_WB.p, multiply(from_yaw(TURN), X_WB.q)))


def _shift(reach: PalletReach) -> None:
    X_WB = reach.X_WB
    reach.move(Pose(X_WB.p + SHIFT, X_WB.q))


def _exchange(reach: PalletReach) -> None:
    """Put a box of another size where the right one stood."""
    X_WB, body = reach.X_WB, reach.body
    x, y, z = body.size
    other = BoxBody("another box", (x - 0.06, y - 0.04, z), body.mass)
    reach.cell.simulator.remove(reach.box)
    reach.cell.simulator.spawn(other, X_WB)


def _add_beside(reach: PalletReach) -> None:
    height = reach.cell.simulator.nominal.picking_table.height
    _add(reach, np.array([*(reach.X_WB.p + BESIDE)[:2], height]))


def _add_on_table_b(reach: PalletReach) -> None:
    table = reach.cell.simulator.nominal.reorientation_table
    corner = np.array(table.centre) - 0.5 * np.array(table.size)
    _add(reach, np.array([*(corner + 0.2), table.height]))


def _add_at_place(reach: PalletReach) -> None:
    planned = next(item for item in reach.cell.palletizer.report().boxes if item.name == reach.box)
    x, y = planned.X_WB.p[:2]
    _add(reach, np.array([x, y, reach.cell.simulator.nominal.pallet.deck_height]))


def _add(reach: PalletReach, foot_W: Array) -> None:
    body = BoxBody("another box", OTHER, 2.0)
    reach.cell.simulator.spawn(body, Pose(foot_W + np.array([0.0, 0.0, 0.5 * OTHER[2]])))


def _lose_vacuum(reach: PalletReach) -> None:
    reach.cell.simulator.gripper.fail("the vacuum was lost")


def _silence_camera(reach: PalletReach) -> None:
    reach.cell.camera_is_silent = True


DEEDS: dict[str, PalletDeed] = {
    "box removed": _remove,
    "box turned by 20 degrees": _turn,
    "box shifted by 60 mm": _shift,
    "box exchanged for a smaller one": _exchange,
    "another box put beside it": _add_beside,
    "another box put on table B": _add_on_table_b,
    "another box put in its place": _add_at_place,
    "vacuum lost": _lose_vacuum,
    "camera silent": _silence_camera,
}
REMOVED, TURNED, SHIFTED, EXCHANGED, BESIDE_IT, ON_TABLE_B, IN_PLACE, VACUUM, CAMERA = DEEDS
IN_PICTURES = (EXCHANGED, BESIDE_IT)
"""Deeds that only a picture shows; in all other cases boxes are found by their true poses with noise."""
