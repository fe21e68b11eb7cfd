from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_motion.reference.refusal import MoveRefused
from pack_motion.reference.speed_profile import Portion, border_speeds, change_length, portion_profile

portions = st.builds(
    Portion, length=st.floats(0.002, 2.0), speed=st.floats(0.05, 1.0), acceleration=st.floats(0.5, 5.0),
    exit_speed=st.floats(0.0, 1.0),
)  # fmt: skip


def test_a_long_change_of_speed_is_a_ramp_and_its_roundings() -> None:
    portion = Portion(1.0, speed=1.0, acceleration=2.0, exit_speed=0.0)
    assert change_length(portion, 1.0, 0.0) == pytest.approx(0.5 * (1.0 / 2.0 + 0.1))


def test_a_short_change_of_speed_never_reaches_the_acceleration() -> None:
    portion = Portion(1.0, speed=1.0, acceleration=2.0, exit_speed=0.0)
    assert change_length(portion, 0.0, 0.05) == pytest.approx(0.5 * 0.05 * 2.0 * (0.05 / 20.0) ** 0.5)


@given(run=st.lists(portions, min_size=1, max_size=4), entry=st.floats(0.0, 1.0))
def test_every_portion_is_long_enough_for_the_speeds_at_its_borders(run: list[Portion], entry: float) -> None:
    speeds = border_speeds(run, entry)
    assert speeds[0] <= entry
    for i, portion in enumerate(run):
        assert speeds[i + 1] <= portion.exit_speed
        profile = portion_profile(portion, speeds[i], speeds[i + 1])
        extent = profile.position_extrema[0]
        assert extent.min >= -1e-6
        assert extent.max <= portion.length + 1e-6


def test_a_line_too_short_to_brake_on_is_refused_rather_than_overrun() -> None:
    with pytest.raises(MoveRefused, match="cannot be entered at 1"):
        portion_profile(Portion(0.1, 1.0, 2.0, 0.0), 1.0, 0.0)


def test_a_length_at_which_a_phase_vanishes_is_travelled_all_the_same() -> None:
    portion = Portion(2.0 * 25.0 * 0.1**3 * 1.0000000000000009, speed=0.5, acceleration=2.5, exit_speed=0.0)
    assert portion_profile(portion, 0.0, 0.0).duration == pytest.approx(0.4, rel=1e-3)
