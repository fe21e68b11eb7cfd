"""The external force over a goal."""

from __future__ import annotations

import numpy as np
import pytest

from pack_mpc.force_record import ForceRecord


def test_nothing_new_leaves_the_filter_as_it_was() -> None:
    forces, with_gaps, without = np.array([10.0, 20.0, 5.0]), ForceRecord(), ForceRecord()
    for force in forces:
        assert with_gaps.note(np.zeros(0)) == 0.0
        assert with_gaps.note(np.array([force])) == pytest.approx(without.note(np.array([force])))
    assert with_gaps.mean == pytest.approx(forces.mean())
