"""The dictionary of tool orientations that chapter 5 of the thesis prints, and where it can be followed.

The thesis gives Euler angles about the world's fixed x, y and z axes for every `orient_id`. From above the
tool works where the angle about y is a quarter turn (Sec. 5.3), so its frame has its approach axis along x. A
box that was gripped in the orientation of id 0 and is turned with the tool to that of another id has extents
that follow from the angles alone. They are those of `handling.PERMUTATIONS` with `bundling_axis` z for the
ids 0, 2, 4 and 5. Ids 1 and 5 have the same angles, and 2 and 3 leave a box with the same extents, so that
two of the six orientations of a box cannot be had; for `bundling_axis` y, whose bypass rules are others, no
angles are printed.
"""

from __future__ import annotations

import numpy as np

from pack_core.palletizing.orders.handling import PERMUTATIONS, BundlingAxis, OrientId
from pack_core.rotations import POINTING_DOWN, Array, conjugate, from_rpy, multiply, to_matrix

QUARTER = np.pi / 2.0
EULER: dict[OrientId, tuple[float, float, float]] = {
    0: (0.0, QUARTER, 0.0),
    1: (QUARTER, 0.0, QUARTER),
    2: (QUARTER, 0.0, 0.0),
    3: (-QUARTER, 0.0, 0.0),
    4: (QUARTER, QUARTER, 0.0),
    5: (QUARTER, 0.0, QUARTER),
}
"""Angles about the world's x, y and z [rad], as printed in Sec. 5.1."""


def printed_turn(orient_id: OrientId) -> Array:
    """The rotation of tool and box from the orientation of id 0 to that of another id, wxyz `(4,)`."""
    return multiply(from_rpy(EULER[orient_id]), conjugate(from_rpy(EULER[0])))


def printed_extents(orient_id: OrientId) -> tuple[int, int, int]:
    """Which of d_x, d_y and d_z lie along x, y and z after the printed turn."""
    i, j, k = np.argmax(np.abs(to_matrix(printed_turn(orient_id))), axis=1).tolist()
    return i, j, k


def printed_orientation(orient_id: OrientId, axis: BundlingAxis) -> Array | None:
    """Orientation q_WT, wxyz `(4,)`, that an id gives the tool; None where the dictionary cannot be followed.

    The thesis does not state how the tool is turned about its approach axis. It is taken to look down with
    its x axis along the world's at id 0, which makes no difference to the box: it was gripped so.
    """
    if axis != "z" or printed_extents(orient_id) != PERMUTATIONS[orient_id]:
        return None
    return np.asarray(multiply(printed_turn(orient_id), POINTING_DOWN))
