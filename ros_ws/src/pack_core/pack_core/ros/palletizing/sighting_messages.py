"""A sighting of the calibration board as a message and back."""

from __future__ import annotations

import numpy as np
from pack_interfaces.msg import BoardSighting as BoardSightingMsg

from pack_core.errors import MessageError
from pack_core.palletizing.board_sighting import BoardSighting
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.ros.conversions import finite, from_stamp, to_stamp


def to_sighting(sighting: BoardSighting) -> BoardSightingMsg:
    """A message of a sighting."""
    u, v = sighting.pixels.T.tolist()
    message = BoardSightingMsg(width=sighting.width, ids=sighting.ids.tolist(), u=u, v=v)
    message.header.stamp = to_stamp(sighting.time)
    return message


def from_sighting(message: BoardSightingMsg) -> BoardSighting:
    """The sighting in a message; MessageError where it must not be used."""
    ids, most = np.array(message.ids, dtype=int), len(CALIBRATION_BOARD.corners())
    pixels = [finite(values, f"corners, {name}") for name, values in (("u", message.u), ("v", message.v))]
    if not message.width or any(len(values) != len(ids) for values in pixels) or np.any(ids >= most):
        raise MessageError(
            f"{len(ids)} corners with {len(pixels[0])} u and {len(pixels[1])} v in a picture of width "
            f"{message.width}; allowed: as many of each, and numbers below {most}"
        )
    return BoardSighting(from_stamp(message.header.stamp), message.width, ids, np.column_stack(pixels))
