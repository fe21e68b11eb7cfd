"""How the new object hangs on the cup."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.model import held_pose
from pack_core.rotations import Pose, exp, multiply
from pack_perception.mocap.grip_tracker import GripConfig, GripTracker

CONFIG = GripConfig()
NOMINAL = held_pose(packing_cell().scene)


@pytest.fixture
def tracker() -> GripTracker:
    return GripTracker(CONFIG, NOMINAL)


def off(metres: float, degrees: float = 0.0) -> Pose:
    return Pose(
        NOMINAL.p + np.array([metres, 0.0, 0.0]), multiply(exp([np.deg2rad(degrees), 0.0, 0.0]), NOMINAL.q)
    )


def test_a_slightly_shifted_grip_is_learnt(tracker: GripTracker) -> None:
    for k in range(100):
        tracker.correct(off(0.005, 5.0), k / 120)
    assert tracker.is_held
    assert np.allclose(tracker.X_TN.p, off(0.005).p, atol=1e-5)
    assert np.allclose(tracker.X_TN.q, off(0.0, 5.0).q, atol=1e-4)


@pytest.mark.parametrize("seen", [off(0.021), off(0.0, 21.0)])
def test_an_object_seen_elsewhere_for_long_enough_is_lost(tracker: GripTracker, seen: Pose) -> None:
    tracker.correct(seen, 1.0)
    tracker.correct(seen, 1.0 + 0.9 * CONFIG.patience)
    assert tracker.is_held
    tracker.correct(seen, 1.0 + 1.1 * CONFIG.patience)
    assert not tracker.is_held


def test_a_short_outlier_changes_nothing(tracker: GripTracker) -> None:
    tracker.correct(off(0.05), 1.0)
    tracker.correct(off(0.0), 1.1)
    tracker.correct(off(0.05), 1.3)
    assert tracker.is_held
    assert np.allclose(tracker.X_TN.p, NOMINAL.p)
