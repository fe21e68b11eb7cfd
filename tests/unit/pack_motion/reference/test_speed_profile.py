from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_motion.reference.line_run import SegmentLimits, border_speeds, change_length, speed_profile
from pack_motion.reference.trajectory import MoveRefused

limits = st.builds(
    SegmentLimits, length=st.floats(0.002, 2.0), speed=st.floats(0.05, 1.0), acceleration=st.floats(0.5, 5.0),
    exit_speed=st.floats(0.0, 1.0),
)  # fmt: skip


def test_a_long_change_of_speed_is_a_ramp_and_its_roundings() -> None:
    limits = SegmentLimits(1.0, speed=1.0, acceleration=2.0, exit_speed=0.0)
    assert change_length(limits, 1.0, 0.0) == pytest.approx(0.5 * (1.0 / 2.0 + 0.1))


def test_a_short_change_of_speed_never_reaches_the_acceleration() -> None:
    limits = SegmentLimits(1.0, speed=1.0, acceleration=2.0, exit_speed=0.0)
    assert change_length(limits, 0.0, 0.05) == pytest.approx(0.5 * 0.05 * 2.0 * (0.05 / 20.0) ** 0.5)


@given(run=st.lists(limits, min_size=1, max_size=4), entry=st.floats(0.0, 1.0))
def test_every_segment_is_long_enough_for_the_speeds_at_its_borders(
    run: list[SegmentLimits], entry: float
) -> None:
    speeds = border_speeds(run, entry)
    assert speeds[0] <= entry
    for i, limits in enumerate(run):
        assert speeds[i + 1] <= limits.exit_speed
        profile = speed_profile(limits, speeds[i], speeds[i + 1])
        extent = profile.position_extrema[0]
        assert extent.min >= -1e-6
        assert extent.max <= limits.length + 1e-6


def test_a_line_too_short_to_brake_on_is_refused_rather_than_overrun() -> None:
    with pytest.raises(MoveRefused, match="cannot be entered at 1"):
        speed_profile(SegmentLimits(0.1, 1.0, 2.0, 0.0), 1.0, 0.0)


def test_a_length_at_which_a_phase_vanishes_is_travelled_all_the_same() -> None:
    limits = SegmentLimits(
        2.0 * 25.0 * 0.1**3 * 1.0000000000000009, speed=0.5, acceleration=2.5, exit_speed=0.0
    )
    assert speed_profile(limits, 0.0, 0.0).duration == pytest.approx(0.4, rel=1e-3)
