"""The report of a shift says what its journal says, and where the time went."""

import pytest

from pack_core.palletizing.cell import PALLET, REJECT_TABLE, REORIENTATION_TABLE
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.shift_journal import WATCHED, EventKind, ShiftEvent, WrittenShift
from pack_evaluation.palletizing.shift_report import built_pallets, order_of_pallet, shift_report

SIZE = (0.4, 0.3, 0.2)


def put_down(time: float, box: str, place: str = PALLET, lower=(0.0, 0.0, 0.0), size=SIZE) -> ShiftEvent:
    item = Item(id=box, article="tea", size=SIZE, weight=5.0, this_side_up=False).model_dump(mode="json")
    handling = "table" if size[2] != 0.2 else "none"
    data = {"item": item, "lower": list(lower), "size": list(size), "handling": handling}
    return ShiftEvent(time, EventKind.PUT_DOWN, box, place, data=data)


def state(time: float, name: str, reason: str = "") -> ShiftEvent:
    return ShiftEvent(time, EventKind.STATE, "b", "", reason, {"state": name})


def decided(time: float, box: str, step: str, reason: str = "") -> ShiftEvent:
    return ShiftEvent(time, EventKind.DECIDED, box, "", reason, {"step": step})


def came(time: float, box: str) -> ShiftEvent:
    return ShiftEvent(time, EventKind.CAME, box)


EVENTS = (
    ShiftEvent(0.0, EventKind.BEGAN),
    came(10.0, "a"), decided(10.1, "a", "place"), state(10.1, "3 grasp"), put_down(18.0, "a"),
    state(20.0, "done"),
    came(26.0, "b"), decided(26.1, "b", "reject", "its label cannot be read"), state(27.0, "3 grasp"),
    state(29.0, "grip failed", "no box"), put_down(34.0, "b", REJECT_TABLE), state(36.0, "done"),
    ShiftEvent(37.0, EventKind.TAKEN, "", PALLET, data={"boxes": ["a"]}),
    ShiftEvent(500.0, EventKind.BEGAN),
    came(506.0, "c"), decided(506.1, "c", "set aside"), state(506.1, "3 grasp"),
    put_down(510.0, "c", REORIENTATION_TABLE), state(511.0, "3 grasp"),
    put_down(512.0, "c", PALLET, (0.5, 0.1, 0.0), (0.3, 0.2, 0.4)), state(513.0, "done"),
    ShiftEvent(514.0, EventKind.ENDED, reason="all boxes came"),
)  # fmt: skip


def test_boxes_faults_and_waits_are_counted() -> None:
    report = shift_report(WrittenShift({"seed": 3}, EVENTS))
    assert (report["came"], report["settled"], report["on_pallets"]) == (3, 3, 2)
    assert (report["set_aside"], report["rejected"]) == (1, {"b": "its label cannot be read"})
    assert report["faults"] == {"grip failed": 1}
    assert report["handling"] == {"none": 1, "table": 1}
    assert report["reason"] == "all boxes came"
    # From 20 s on nothing was in work; the next box was there after 6 s and was taken 1 s later.
    assert report["waits_s"] == pytest.approx({"a box": 6.0, "an empty pallet or a place": 1.0})
    # Grasps took 9.9 s, 2 s, 4.9 s and 2 s, of two boxes on pallets; the interruption counts nowhere.
    assert report["state_s"]["3 grasp"] == pytest.approx((9.9 + 2.0 + 4.9 + 2.0) / 2)


def test_the_time_in_which_a_shift_was_interrupted_counts_nowhere() -> None:
    report = shift_report(WrittenShift({}, EVENTS))
    # From 10 s to 512 s, less the time from 37 s to 500 s; 7 s of it nothing was in work.
    assert report["duration_s"] == pytest.approx(39.0)
    assert report["boxes_per_hour"] == pytest.approx(3600 * 2 / 39.0)
    assert report["utilisation"] == pytest.approx(1.0 - 7.0 / 39.0)


def test_pallets_are_those_taken_away_and_those_that_stand() -> None:
    taken, stands = built_pallets(EVENTS)
    assert (taken.taken, [box.box for box in taken.boxes]) == (37.0, ["a"])
    assert (stands.taken, [box.box for box in stands.boxes]) == (None, ["c"])
    (box,) = order_of_pallet(stands, "second").boxes
    assert box.placed.size.tolist() == [0.3, 0.2, 0.4]
    assert box.position == (0.5, 0.1, 0.0)


def test_a_shift_in_which_nothing_came_has_a_report() -> None:
    report = shift_report(WrittenShift({}, (ShiftEvent(0.0, EventKind.BEGAN),)))
    assert (report["came"], report["boxes_per_hour"], report["pallets"]) == (0, None, [])


def test_a_shift_that_ended_and_was_gone_on_with_goes_on() -> None:
    events = (ShiftEvent(0.0, EventKind.BEGAN), ShiftEvent(5.0, EventKind.ENDED, reason="box lost"))
    assert shift_report(WrittenShift({}, events))["reason"] == "box lost"
    again = (*events, ShiftEvent(9.0, EventKind.BEGAN))
    assert shift_report(WrittenShift({}, again))["reason"] == "it goes on"


def test_contacts_and_falls_are_told_only_where_a_simulator_watched_for_them() -> None:
    touched = ShiftEvent(
        9.0, EventKind.TOUCHED, reason="arm and box for 0.10 s, up to 40 N", data={"began": 8.8}
    )
    events = (*EVENTS[:-1], touched, ShiftEvent(9.5, EventKind.FELL, "b", reason="lies on the floor"))
    report = shift_report(WrittenShift({WATCHED: True}, events))
    assert report["unwanted_contacts"] == ["arm and box for 0.10 s, up to 40 N, at 8.8 s"]
    assert report["fallen"] == ["b"]
    assert not {"unwanted_contacts", "fallen"} & shift_report(WrittenShift({}, events)).keys()
