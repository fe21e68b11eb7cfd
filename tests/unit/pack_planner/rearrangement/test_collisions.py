"""Overlaps as bits, against polygons."""

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import hits, rectangles

NEAR = 1e-6


def random_rectangles(n: int, rng: np.random.Generator) -> Array:
    poses = rng.uniform([-0.15, -0.15, -np.pi], [0.15, 0.15, np.pi], (n, 3))
    return rectangles(poses, *rng.uniform(0.005, 0.06, (2, n)))


def polygon(row: Array) -> shapely.Polygon:
    x, y, cosine, sine, half_x, half_y = row
    box = shapely.box(-half_x, -half_y, half_x, half_y)
    return affinity.affine_transform(box, [cosine, -sine, sine, cosine, x, y])


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_hits_are_the_polygons_that_overlap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    moving, blocks = random_rectangles(4, rng), random_rectangles(70, rng)
    words = hits(moving[:, None], blocks)
    assert words.shape == (4, 2)
    for row, rectangle in zip(words, moving, strict=True):
        for q, block in enumerate(blocks):
            is_hit = bool(int(row[q // 64]) >> (q % 64) & 1)
            a, b = polygon(rectangle), polygon(block)
            if is_hit:
                assert a.buffer(NEAR).intersects(b)
            else:
                assert not a.buffer(-NEAR).intersects(b)


def test_touching_is_not_overlapping() -> None:
    blocks = rectangles(np.array([[0.0, 0.0, 0.3]]), 0.02, 0.02)
    beside = rectangles(np.array([[0.04 * np.cos(0.3), 0.04 * np.sin(0.3), 0.3]]), 0.02, 0.02)
    assert hits(beside[:, None], blocks) == 0


def test_a_footprint_hits_what_any_of_its_rectangles_hits() -> None:
    blocks = rectangles(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), 0.1, 0.1)
    footprint = blocks[[0, 2]][None]
    assert hits(footprint, blocks).tolist() == [[0b101]]
