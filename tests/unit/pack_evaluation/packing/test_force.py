import numpy as np
import pytest

from pack_evaluation.packing.force import FILTER_TIME, low_pass

TIMES = np.arange(0.0, 0.2, 0.001)


def test_a_constant_force_passes_unchanged() -> None:
    np.testing.assert_allclose(low_pass(TIMES, np.full(TIMES.size, 7.0)), 7.0)


def test_a_step_has_risen_to_63_percent_after_the_filter_time() -> None:
    step = (TIMES >= 0.1).astype(float)
    filtered = low_pass(TIMES, step)
    at = int(np.searchsorted(TIMES, 0.1 + FILTER_TIME - 1.5e-3))
    assert filtered[at] == pytest.approx(1.0 - np.exp(-1.0), abs=0.08)
    assert filtered[-1] == pytest.approx(1.0, abs=1e-6)


def test_a_spike_of_one_millisecond_counts_for_its_share_of_the_filter_time() -> None:
    spike = np.zeros(TIMES.size)
    spike[100] = 100.0
    assert low_pass(TIMES, spike).max() == pytest.approx(100.0 * (1.0 - np.exp(-0.001 / FILTER_TIME)))


def test_no_and_one_sample_come_back_as_they_are() -> None:
    assert low_pass(np.empty(0), np.empty(0)).size == 0
    np.testing.assert_array_equal(low_pass(np.zeros(1), np.array([3.0])), [3.0])
