"""The external force over a goal."""

from __future__ import annotations

import numpy as np
import pytest

from pack_mpc.task.force_record import GAIN, ForceRecord

ALONG = np.array([0.6, 0.0, -0.8])


def test_nothing_new_leaves_the_filter_as_it_was() -> None:
    forces, with_gaps, without = np.array([10.0, 20.0, 5.0]), ForceRecord(), ForceRecord()
    for force in forces:
        assert with_gaps.note(np.zeros((0, 3))) == 0.0
        assert with_gaps.note(force * ALONG[None]) == pytest.approx(without.note(force * ALONG[None]))
    assert with_gaps.mean == pytest.approx(forces.mean())


def test_the_filter_answers_a_step_as_a_first_order_low_pass() -> None:
    record, forces = ForceRecord(), np.tile(30.0 * ALONG, (7, 1))
    assert record.note(forces) == pytest.approx(30.0 * (1.0 - (1.0 - GAIN) ** 7))
    assert record.note(forces[:1]) == pytest.approx(30.0 * (1.0 - (1.0 - GAIN) ** 8))
    assert record.peak == pytest.approx(30.0)
