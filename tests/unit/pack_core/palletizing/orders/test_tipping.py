"""The closed tipping rule against closed forms and against physics."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import margin_in, polygon_of
from pack_core.palletizing.orders.tipping import TippingConfig, pushes_of, tipping_boxes


def box(name: str, lower: tuple[float, ...], size: tuple[float, ...], mass: float = 1.0) -> PlacedBox:
    return PlacedBox(name, np.array(lower), np.array(size), mass)


def test_a_single_box_tips_about_its_shorter_edge() -> None:
    """An upright block of width w and height h stands up to g = w / h."""
    assert pushes_of([box("a", (0, 0, 0), (0.4, 0.3, 0.6))]) == {"a": pytest.approx(0.3 / 0.6)}


def test_of_two_boxes_the_lower_one_tips_with_the_upper_on_it() -> None:
    """Two boxes of mass m and M, the upper one displaced by d: the common centre decides."""
    m, M, d, w, h = 2.0, 8.0, 0.1, 0.4, 0.2
    pushes = pushes_of([box("upper", (d, 0, h), (w, w, 2 * h), M), box("lower", (0, 0, 0), (w, w, h), m)])
    centre = (m * w / 2 + M * (w / 2 + d)) / (m + M)
    height = (m * h / 2 + M * 2 * h) / (m + M)
    assert pushes["lower"] == pytest.approx((w - centre) / height)
    # The upper one stands on what both share: from d to w.
    assert pushes["upper"] == pytest.approx((w - (w / 2 + d)) / h)


def test_a_cantilever_is_held_by_the_weight_on_its_other_end() -> None:
    """A board that sticks out by more than half stands only with a counterweight."""
    base, board = box("base", (0, 0, 0), (0.4, 0.4, 0.2), 9.0), box("board", (0.2, 0, 0.2), (0.5, 0.4, 0.1))
    counter = box("counter", (0.2, 0, 0.3), (0.15, 0.4, 0.1), 3.0)
    assert pushes_of([base, board])["board"] < 0.0
    centre = (1.0 * 0.45 + 3.0 * 0.275) / 4.0
    height = (1.0 * 0.05 + 3.0 * 0.15) / 4.0
    assert pushes_of([base, board, counter])["board"] == pytest.approx(min(0.4 - centre, 0.2) / height)


def test_a_bridge_hands_half_of_its_load_to_each_pier() -> None:
    piers = [box("left", (0, 0, 0), (0.2, 0.4, 0.2)), box("right", (0.6, 0, 0), (0.2, 0.4, 0.2))]
    bridge = box("bridge", (0, 0, 0.2), (0.8, 0.4, 0.1), 6.0)
    pushes = pushes_of([*piers, bridge])
    assert pushes["left"] == pytest.approx(pushes["right"])
    # Half of the bridge acts in the middle of each contact, at the height of the bridge's centre.
    assert pushes["left"] == pytest.approx(0.1 / ((1.0 * 0.1 + 3.0 * 0.25) / 4.0))


def test_a_box_that_floats_tips_and_is_named() -> None:
    wanted = tipping_boxes([box("a", (0, 0, 0), (0.4, 0.4, 0.2)), box("b", (0, 0, 0.5), (0.4, 0.4, 0.2))],
                           TippingConfig())  # fmt: skip
    assert list(wanted) == ["b"]
    assert "wanted: 0.25 g" in wanted["b"]


def test_the_polygon_of_rectangles_is_their_convex_hull() -> None:
    """Against Qhull, for random rectangles and points."""
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(0)
    for _ in range(50):
        lower = rng.uniform(0, 1, (rng.integers(1, 6), 2))
        rectangles = np.hstack([lower, lower + rng.uniform(0.05, 0.5, lower.shape)])
        corners = np.concatenate([rectangles[:, [a, b]] for a in (0, 2) for b in (1, 3)])
        sides, p = polygon_of(rectangles), rng.uniform(-0.2, 1.7, 2)
        normals = np.unique(np.round(ConvexHull(corners).equations, 9), axis=0)
        assert margin_in(sides, *p) == pytest.approx(-(normals[:, :2] @ p + normals[:, 2]).max(), abs=1e-7)
