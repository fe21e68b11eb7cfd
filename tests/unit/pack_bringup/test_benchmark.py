"""The benchmark's summary."""

import math

import pytest

from pack_bringup.benchmark import Trial, spread, summarize


def trial(seed: int, success: bool, time: float, iterations: list[float]) -> Trial:
    return Trial(seed, success, "placed" if success else "timeout", time, 1.2, 2.0, 50.0, 1, iterations)


def test_spread_of_known_values() -> None:
    values = spread([float(i) for i in range(101)])
    assert values["mean"] == values["median"] == 50.0
    assert values["p95"] == pytest.approx(95.0)
    assert values["std"] == pytest.approx(math.sqrt((101**2 - 1) / 12))


def test_no_values_are_not_a_number() -> None:
    assert math.isnan(spread([])["mean"])


def test_summary_counts_and_pools() -> None:
    summary = summarize([trial(0, True, 4.0, [10.0, 20.0]), trial(1, False, 20.0, [60.0])])
    assert summary["scenes"] == 2
    assert summary["success"] == 1
    assert summary["exits"] == {"placed": 1, "timeout": 1}
    assert summary["execution_time_s"]["mean"] == 12.0
    assert summary["iteration_ms"]["median"] == 20.0
