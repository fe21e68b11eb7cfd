import numpy as np
import pytest

from pack_lockstep.packing.recorded_frames import expected_count


def frames(rate: float, seconds: float = 4.0) -> np.ndarray:
    """Stamps of a periodic topic, rounded to milliseconds as a simulator's step rounds them [s]."""
    return np.round(np.arange(0.0, seconds, 1.0 / rate), 3)


@pytest.mark.parametrize("rate", [120.0, 125.0, 250.0, 500.0])
def test_nothing_is_missed_where_nothing_is_missing(rate: float) -> None:
    assert expected_count(frames(rate)) == frames(rate).size


@pytest.mark.parametrize("rate", [120.0, 500.0])
def test_single_messages_and_a_long_gap_are_missed(rate: float) -> None:
    stamps = frames(rate)
    assert expected_count(np.delete(stamps, [7, 100, 101, 102, 200])) == stamps.size
    assert expected_count(np.delete(stamps, np.arange(50, 150))) == pytest.approx(stamps.size, abs=1)
