"""Where a convex outline must not be moved to, so that it keeps off another one."""

from __future__ import annotations

import shapely

from pack_core.rotations import Array


def no_fit_polygon(standing: Array, moved: Array) -> shapely.Polygon:
    """Places of a moved outline's origin at which it meets a standing one: the sum `standing + (-moved)`.

    Both are convex, so the hull of the corners' differences is the whole Minkowski sum.

    Args:
        standing: corners of the outline that stands `(n, 2)` [m].
        moved: corners of the other one about its origin `(m, 2)` [m].
    """
    return shapely.MultiPoint((standing[:, None] - moved[None]).reshape(-1, 2)).convex_hull
