"""The calibration board as it was seen in a picture."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pack_core.rotations import Array


@dataclass(frozen=True)
class BoardSighting:
    """Corners of the board's pattern in one picture.

    Attributes:
        time: when the picture was taken [s].
        width: of the picture [pixel].
        ids: numbers of the corners that were seen `(n,)`; none where no board was found.
        pixels: where they were seen, u and v `(n, 2)` [pixel].
    """

    time: float
    width: int
    ids: Array
    pixels: Array

    def scaled(self, width: int) -> BoardSighting:
        """The same in pictures of another width [pixel]."""
        if width == self.width:
            return self
        # The left edge of both pictures is at -0.5, half a pixel before the first pixel's centre.
        return replace(self, width=width, pixels=(self.pixels + 0.5) * np.float64(width / self.width) - 0.5)
