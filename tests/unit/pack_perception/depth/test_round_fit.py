"""Bodies of revolution fitted to points of a round top."""

import numpy as np
import pytest

from pack_perception.depth.round_fit import WIDEST, revolved
from pack_perception.perception_config import ShapeFitConfig


def test_a_bottle_is_a_body_of_revolution() -> None:
    rng = np.random.default_rng(0)
    z, turn = rng.uniform(0.10, 0.18, 2000), rng.uniform(0.0, 2.0 * np.pi, 2000)
    r = np.interp(z, [0.10, 0.15, 0.18], [0.035, 0.03, 0.012])
    points = np.column_stack([0.5 + r * np.cos(turn), 0.02 + r * np.sin(turn), z])
    fit = revolved(points, "seen_1", ShapeFitConfig())
    assert fit is not None
    _, X_WO = fit[1]()
    assert X_WO.p[:2] == pytest.approx([0.5, 0.02], abs=0.001)


def test_radii_are_bounded_also_on_a_slope_that_is_longer() -> None:
    x, y = np.meshgrid(np.linspace(0.4, 0.6, 60), np.linspace(-0.02, 0.02, 12))
    slope = np.column_stack([x.ravel(), y.ravel(), 0.05 + 0.4 * (x.ravel() - 0.4)])
    fit = revolved(slope, "seen_1", ShapeFitConfig())
    assert fit is not None
    item, _ = fit[1]()
    assert item.half_extents[:2].max() < WIDEST + 1e-6
