"""Disturbances on table B and on the pallet, in the whole cell: seen by scanners and named in the reason.

What the cell does about a box that is gone or turned, at each place, is tested without physics, in
`tests/unit/pallet_fsm/test_place_watch.py`.
"""

from __future__ import annotations

import pytest

from pack_lockstep.disturbances import Disturbance, DisturbanceReport
from pack_lockstep.palletizing.disturbances import run_case


def after(what: str, when: str) -> DisturbanceReport:
    report = run_case(Disturbance(what, when), seed=0)
    assert not report.problem
    return report


@pytest.mark.timeout(300)
def test_a_box_that_leaves_its_place_on_the_pallet_stops_the_arm_with_an_empty_hand() -> None:
    report = after("box shifted by 60 mm", "retreat")
    assert "box lower stands 60 mm" in report.noticed[0]
    assert report.noticed_after < 2.0
    assert report.ended == "stopped: lower lost, upper pending"
    assert report.touches == 0


@pytest.mark.long  # table B is scanned in physics below, and what is then done is tested without physics
@pytest.mark.timeout(300)
def test_a_box_that_does_not_stay_on_table_b_is_skipped_with_what_would_stand_on_it() -> None:
    report = after("box turned by 20 degrees", "above table")
    assert "degrees from its place" in report.noticed[0]
    assert report.ended == "lower skipped, upper skipped"
    assert report.touches == 0


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("what", "when"),
    [
        ("another box put on table B", "rotate"),
        # the pallet is scanned in physics above, and what is then done is tested without physics
        pytest.param("another box put in its place", "above pallet", marks=pytest.mark.long),
    ],
)
def test_another_box_where_the_carried_one_is_to_stand_stops_the_arm_before_they_meet(
    what: str, when: str
) -> None:
    report = after(what, when)
    assert "that should not be there" in report.noticed[0]
    assert report.ended == "stopped: lower pending, upper pending"
    assert report.touches == 0
