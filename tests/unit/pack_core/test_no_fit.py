"""Where a convex outline must not be moved to."""

from __future__ import annotations

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from pack_core.no_fit import no_fit_polygon
from pack_core.rotations import Array

NEAR = 1e-9
"""Closer to the border of touching than this, rounding decides [m]."""


@st.composite
def outlines(draw: st.DrawFn) -> Array:
    """Corners of a convex outline `(n, 2)` [m]: a regular polygon, stretched and turned."""
    count = draw(st.integers(3, 8))
    angles = draw(st.floats(0.0, np.pi)) + 2 * np.pi * np.arange(count) / count
    size = [draw(st.floats(0.01, 0.1)), draw(st.floats(0.01, 0.1))]
    return np.column_stack([np.cos(angles), np.sin(angles)]) * size


@given(outlines(), outlines(), st.tuples(st.floats(-0.25, 0.25), st.floats(-0.25, 0.25)))
def test_outlines_meet_exactly_where_the_moved_one_stands_in_it(
    standing: Array, moved: Array, at: tuple[float, float]
) -> None:
    met, place = no_fit_polygon(standing, moved), shapely.Point(at)
    if met.exterior.distance(place) > NEAR:
        meets = shapely.Polygon(standing).intersects(shapely.Polygon(moved + np.array(at)))
        assert met.contains(place) == meets
