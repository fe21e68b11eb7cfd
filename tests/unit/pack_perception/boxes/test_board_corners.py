"""The calibration board in pictures: found where it is, and nowhere else."""

import numpy as np

from pack_core.camera import Picture
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_perception.boxes.board_corners import sight_board

LEFT, UPPER, SQUARE = 700, 300, 40
"""Where the pattern's upper left corner lies in the picture, and the side of its squares [pixel]."""


def shown() -> Picture:
    """The pattern, flat, in a picture of 1920 x 1080."""
    columns, rows = CALIBRATION_BOARD.squares
    pattern = CALIBRATION_BOARD.pattern.generateImage((columns * SQUARE, rows * SQUARE), None, 0, 1)
    picture = np.full((1080, 1920, 3), 150, dtype=np.uint8)
    picture[UPPER : UPPER + rows * SQUARE, LEFT : LEFT + columns * SQUARE] = pattern[..., None]
    return picture


def test_every_corner_is_seen_where_it_is() -> None:
    seen = sight_board(shown(), 2.5)
    assert (seen.time, seen.width) == (2.5, 1920)
    assert sorted(seen.ids) == list(range(len(CALIBRATION_BOARD.corners())))
    columns = CALIBRATION_BOARD.squares[0] - 1
    across, down = seen.ids % columns + 1, seen.ids // columns + 1
    # An edge between two squares lies half a pixel before the centre of the first pixel behind it.
    wanted = np.column_stack([LEFT + SQUARE * across, UPPER + SQUARE * down]) - 0.5
    np.testing.assert_allclose(seen.pixels, wanted, atol=0.1)


def test_a_picture_without_the_board_has_no_corners() -> None:
    seen = sight_board(np.full((1080, 1920, 3), 150, dtype=np.uint8), 1.0)
    assert (len(seen.ids), seen.pixels.shape) == (0, (0, 2))


def test_a_sighting_is_the_same_in_a_picture_of_twice_the_width() -> None:
    seen = sight_board(shown(), 2.5)
    twice = seen.scaled(2 * seen.width)
    # The left edge of a picture is at -0.5 whatever its width.
    np.testing.assert_allclose(twice.pixels + 0.5, 2.0 * (seen.pixels + 0.5))
    assert seen.scaled(seen.width) is seen
