"""Measures of runs whose errors are known."""

import pytest

from pack_evaluation.palletizing.measures import measure_order, shifts_mm
from pack_evaluation.palletizing.run import BoxRecord, StateVisit, UnwantedTouch
from unit.pack_evaluation.palletizing.known_run import a_run, track


def test_tracking_is_the_distance_between_commanded_and_measured_tool() -> None:
    m = measure_order(a_run())
    assert m.position_mm == pytest.approx((0.5, 0.5))
    assert m.orientation_deg == pytest.approx((0.0, 0.0))
    assert m.goal_mm == pytest.approx((0.5, 0.5))


def test_boxes_near_their_places_are_rewarded() -> None:
    m = measure_order(a_run())
    assert (m.reward, m.penalty, m.is_complete) == (2, 0, True)
    assert [box.error_mm for box in m.boxes] == pytest.approx([0.0, 1.0])


@pytest.mark.parametrize(
    ("offset", "angle_deg", "is_ok"),
    [(0.0049, 0.0, True), (0.0051, 0.0, False), (0.0, 0.9, True), (0.0, 1.1, False)],
)
def test_a_box_is_in_place_within_5_mm_and_1_degree(offset: float, angle_deg: float, is_ok: bool) -> None:
    run = a_run()
    tracks = {**run.tracks, "b": track("b", {0.0: [offset, 0.0, 0.0]}, angle_deg)}
    m = measure_order(a_run(tracks=tracks))
    assert m.boxes[1].is_ok is is_ok
    assert m.is_complete is is_ok


def test_the_fall_of_a_box_from_the_gripper_is_no_shift() -> None:
    assert shifts_mm(a_run()) == pytest.approx((0.0,), abs=1e-9)


def test_a_box_that_the_next_one_pushes_is_a_shift() -> None:
    pushed = {0.0: [-2.0, 2.0, 0.5], 10.0: [0.0, 0.0, 0.0], 21.0: [0.0, 0.003, 0.0]}
    run = a_run()
    assert max(shifts_mm(a_run(tracks={**run.tracks, "a": track("a", pushed)}))) == pytest.approx(3.0)


def test_the_way_down_of_a_box_that_was_interrupted_is_no_shift() -> None:
    run = a_run()
    lowered = {0.0: [0.0, 0.0, 0.15], 21.0: [0.0, 0.0, 0.0]}
    pushed = {0.0: [-2.0, 2.0, 0.5], 10.0: [0.0, 0.0, 0.0], 20.5: [0.0, 0.003, 0.0]}
    visits = (*run.visits[:4], StateVisit("17 pre deposit", 20.8, "b"), run.visits[4])
    tracks = {"a": track("a", pushed), "b": track("b", lowered)}
    assert shifts_mm(a_run(visits=visits, tracks=tracks)) == pytest.approx((3.0,))


def test_a_lost_box_is_a_drop_and_spoils_the_order() -> None:
    run = a_run()
    lost = BoxRecord("b", (0.4, 0.3, 0.2), 5.0, "none", "lost", "shear", "Center", run.boxes[1].X_WB)
    m = measure_order(a_run(boxes=(run.boxes[0], lost)))
    assert (m.drops, m.penalty, m.is_complete) == (1, 1, False)
    assert m.boxes[1].error_mm is None


def test_faults_and_touches_are_counted_with_what_they_were() -> None:
    visits = (*a_run().visits, StateVisit("grip failed", 30.0, "b", "no face within reach"))
    m = measure_order(a_run(visits=visits, touches=(UnwantedTouch(5.0, ("a", "tool"), 33.0),)))
    assert m.faults == ("grip failed: no face within reach",)
    assert m.touches == 1
