import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_evaluation.spread import auc, split, spread

numbers = st.lists(st.integers(-5, 5).map(float), min_size=1, max_size=12)


def test_spread_of_the_integers_from_0_to_100() -> None:
    values = spread([float(i) for i in range(101)])
    assert values.mean == values.median == 50.0
    assert values.p95 == pytest.approx(95.0)
    assert values.deviation == pytest.approx(math.sqrt((101**2 - 1) / 12))


def test_no_values_have_no_spread() -> None:
    assert spread([]).mean is None


def test_what_a_trial_does_not_have_is_left_out() -> None:
    assert spread([1.0, math.nan, 3.0]).mean == 2.0


@given(numbers, numbers)
def test_auc_counts_the_pairs_in_which_the_failure_measures_more(low: list[float], high: list[float]) -> None:
    pairs = [(b > a) + 0.5 * (b == a) for a in low for b in high]
    assert auc(low, high) == pytest.approx(np.mean(pairs))


@given(numbers, numbers)
def test_auc_of_exchanged_groups_adds_up_to_one(low: list[float], high: list[float]) -> None:
    forward, backward = auc(low, high), auc(high, low)
    assert forward is not None
    assert backward is not None
    assert forward + backward == pytest.approx(1.0)


def test_without_failures_there_is_no_auc() -> None:
    found = split([1.0, 2.0], [])
    assert found.auc is None
    assert found.failure.mean is None
    assert found.success.mean == 1.5
