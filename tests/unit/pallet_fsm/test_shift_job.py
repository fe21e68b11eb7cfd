"""Shifts from start to end in a cell without physics."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.palletizing.cell import PALLET, REJECT_TABLE, REORIENTATION_TABLE, SECOND_PALLET
from pack_core.palletizing.orders.item_list import Item, order_box, placed_item
from pack_core.palletizing.orders.layout_plan import PlannedBox
from pack_core.palletizing.orders.next_place import NextStep, PlaceAnswer
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.ports import (
    AskPlace,
    Command,
    OpenGripper,
    PalletObservation,
    PursueTarget,
    SendBox,
)
from pack_core.palletizing.shift_journal import EventKind
from pack_core.rotations import Pose
from pack_planner.layout.online_planner import OnlineConfig, OnlinePackerConfig
from pallet_fsm.box_watch import BoxWatch
from pallet_fsm.intake import Arrival
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import FeederConfig, PalletizerConfig, ScanConfig
from pallet_fsm.report import BoxOutcome
from pallet_fsm.shift_floor import STRAIGHT_DOWN, ShiftFloor
from pallet_fsm.shift_job import ShiftJob
from unit.pallet_fsm import fake_motion, fake_shift
from unit.pallet_fsm.fake_motion import REFUSED, segments
from unit.pallet_fsm.fake_shift import CELL, Came, FakeShiftCell, ShiftRunning, go_on, listed, run_shift
from unit.pallet_fsm.faults import Faults

TEA = listed("tea")
LARGE = listed("large", (0.59, 0.39, 0.15))
LOW = OnlineConfig(packer=OnlinePackerConfig(highest=0.16))
"""A single layer: a pallet holds four large boxes."""


def test_boxes_that_come_stand_where_it_was_decided() -> None:
    shift = run_shift([Came("tea")] * 4, [TEA], scans=ScanConfig())
    assert shift.job.reason == "all boxes came"
    put_down = shift.of(EventKind.PUT_DOWN)
    assert [event.box for event in put_down] == ["b1", "b2", "b3", "b4"]
    for event in put_down:
        centre = np.array(event.data["lower"]) + 0.5 * np.array(event.data["size"])
        p_WB = CELL.deck(event.place).X_WD.apply(centre)
        assert np.linalg.norm(shift.cell.boxes[event.box].p - p_WB) < 1e-3


def test_the_next_box_is_sent_for_while_the_one_before_is_on_its_way() -> None:
    shift = run_shift([Came("tea")] * 3, [TEA])
    put_down = [event.time for event in shift.of(EventKind.PUT_DOWN)]
    assert len(shift.cell.sent) == 3
    assert all(sent < down for sent, down in zip(shift.cell.sent[1:], put_down, strict=False))


@pytest.mark.parametrize(
    ("odd", "reason"),
    [
        (Came("tea", (0.4, 0.3, 0.18)), "it is 400 x 300 x 180 mm, its label says 400 x 300 x 200 mm"),
        (Came("", (0.4, 0.3, 0.2)), "its label cannot be read"),
        (Came("coal", (0.4, 0.3, 0.2)), "its label says 'coal', which is in no list"),
    ],
)
def test_a_box_that_is_not_what_its_label_says_is_rejected_and_the_shift_goes_on(odd, reason) -> None:
    shift = run_shift([odd, Came("tea")], [TEA])
    places = {event.box: event.place for event in shift.of(EventKind.PUT_DOWN)}
    assert places == {"b1": REJECT_TABLE, "b2": PALLET}
    assert shift.of(EventKind.CAME)[0].reason == reason
    assert "b1" not in shift.cell.boxes
    assert shift.job.reason == "all boxes came"


@pytest.mark.parametrize("on_the_way", [2.0, 0.1])
def test_three_rejected_boxes_in_a_row_call_a_person(on_the_way, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fake_shift, "ON_THE_WAY", on_the_way)
    shift = run_shift([Came("tea"), *[Came("", (0.4, 0.3, 0.2))] * 5], [TEA])
    assert shift.job.reason == "3 boxes in a row belong on no pallet: look at the conveyor"
    assert len(shift.of(EventKind.CAME)) == 4
    assert not shift.cell.has_stopped


def test_the_last_box_is_taken_away_if_it_is_rejected() -> None:
    shift = run_shift([Came("")], [TEA.model_copy(update={"id": ""})])
    assert [(event.box, event.place) for event in shift.of(EventKind.TAKEN)] == [("b1", REJECT_TABLE)]
    assert shift.cell.boxes == {}


def test_a_box_that_stands_upright_is_left_to_a_person_and_the_one_before_it_gets_to_its_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(fake_shift, "ON_THE_WAY", 0.1)  # it is measured while the other one is carried
    shift = run_shift([Came("tea"), Came("tea", (0.3, 0.2, 0.4))], [TEA])
    assert shift.job.reason == "take box b2 off the conveyor: it does not lie on its largest face"
    assert shift.of(EventKind.CAME)[1].time < shift.of(EventKind.PUT_DOWN)[0].time
    assert [event.box for event in shift.of(EventKind.PUT_DOWN)] == ["b1"]
    assert not shift.cell.has_stopped


def test_a_box_that_is_let_go_as_the_arm_is_stopped_stands_where_it_is(monkeypatch) -> None:
    jobs, apply, step = list[ShiftJob](), FakeShiftCell.apply, ShiftJob.step

    def stepping(job: ShiftJob, seen: PalletObservation) -> tuple[Command, ...]:
        jobs.append(job)
        return step(job, seen)

    def stopping(cell: FakeShiftCell, command: Command) -> None:
        apply(cell, command)
        if isinstance(command, OpenGripper):
            jobs[-1].halt("somebody stopped it")

    monkeypatch.setattr(ShiftJob, "step", stepping)
    monkeypatch.setattr(FakeShiftCell, "apply", stopping)
    shift = run_shift([Came("tea")] * 2, [TEA])
    assert shift.job.reason == "somebody stopped it"
    assert shift.cell.has_stopped
    assert [event.box for event in shift.of(EventKind.PUT_DOWN)] == ["b1"]


def test_a_shift_that_begins_with_a_box_at_the_barrier_sees_each_box_once(monkeypatch) -> None:
    # The conveyor hears of a request after it has told once more how things were.
    observe, apply = FakeShiftCell.observe, FakeShiftCell.apply
    requests = list[Command]()

    def late(cell: FakeShiftCell) -> PalletObservation:
        seen = observe(cell)
        while requests:
            if "b1" in cell.boxes and len(cell.sent) == 0:  # it is at the barrier: the belt does not move
                cell.sent.append(cell.time)
                cell._infeed = replace(cell._infeed, number=cell._infeed.number + 1)
                requests.clear()
            else:
                apply(cell, requests.pop())
        return seen

    def keeping(cell: FakeShiftCell, command: Command) -> None:
        requests.append(command) if isinstance(command, SendBox) else apply(cell, command)

    monkeypatch.setattr(FakeShiftCell, "observe", late)
    monkeypatch.setattr(FakeShiftCell, "apply", keeping)
    cell = FakeShiftCell(None, Faults(), stream=[Came("tea")] * 2, catalogue={"tea": TEA})
    cell._bring()
    shift = go_on(cell, 2)
    assert shift.job.reason == "all boxes came"
    assert [event.box for event in shift.of(EventKind.CAME)] == ["b1", "b3"]


def test_what_boxes_bear_is_known_also_of_places_that_came_without_it() -> None:
    floor, item = ShiftFloor(CELL), TEA.model_copy(update={"id": "b1", "max_load": 0.0})
    placed = PlacedBox("b1", np.zeros(3), np.array(item.size), item.weight)
    plan = PlannedBox(placed, STRAIGHT_DOWN)
    arrival = Arrival("b1", item, "", np.array(item.size), None)
    floor.place(PlaceAnswer(1, NextStep.PLACE, "", "b1", PALLET, plan), arrival)
    assert floor.standing(PALLET).boxes[0].max_load == 0.0


def test_a_grip_that_fails_says_nothing_of_the_box_that_was_seen_before() -> None:
    place = PlacedBox(TEA.id, np.zeros(3), np.array(TEA.size), 1.0)
    box, plan = order_box(TEA, place), PlannedBox(place, STRAIGHT_DOWN)
    placed, known = WorkItem(box, plan, has_come=True), WorkItem(box, plan, has_come=True)
    cell = FakeShiftCell(None, Faults(), catalogue={"tea": TEA})
    watch = BoxWatch(PalletizerConfig(), CELL)
    watch.arrival(placed, cell.observe().time)
    placed.X_WB = known.X_WB = Pose(np.zeros(3))
    watch.forget(known)
    assert placed.X_WB is not None
    watch.forget(placed)
    assert placed.X_WB is None


def test_a_full_pallet_is_replaced_while_the_other_one_is_built() -> None:
    # A pallet holds four: the fifth box, and then the ninth, is the first without a place on a full one.
    shift = run_shift([Came("large")] * 11, [LARGE], LOW)
    taken = [(event.place, event.data["boxes"]) for event in shift.of(EventKind.TAKEN)]
    assert taken == [(PALLET, ["b1", "b2", "b3", "b4"]), (SECOND_PALLET, ["b5", "b6", "b7", "b8"])]
    assert shift.job.reason == "all boxes came"
    first = shift.of(EventKind.TAKEN)[0].time
    after = [(event.box, event.place) for event in shift.of(EventKind.PUT_DOWN) if event.time > first]
    on_the_other = [(f"b{n}", SECOND_PALLET) for n in (5, 6, 7, 8)]
    # Where the other one is full, too, before the empty one is there, two are set aside, and go there first.
    aside = [(box, REORIENTATION_TABLE) for box in ("b9", "b10")]
    assert after == [*on_the_other, *aside, *((box, PALLET) for box in ("b9", "b10", "b11"))]
    assert set(shift.cell.boxes) == {"b9", "b10", "b11"}


def test_a_box_that_cannot_be_gripped_is_skipped_and_the_next_one_comes() -> None:
    shift = run_shift([Came("tea")] * 2, [TEA], faults=Faults(slips=3))
    (skipped,) = shift.of(EventKind.SKIPPED)
    assert skipped.box == "b1"
    assert [event.box for event in shift.of(EventKind.PUT_DOWN)] == ["b2"]


def is_over(deck: str, p_W: np.ndarray) -> bool:
    p_D, half = CELL.deck(deck).X_WD.inverse().apply(p_W), 0.5 * np.array(CELL.deck(deck).size)
    return bool(np.all(np.abs(p_D[:2] - half) < half))


@pytest.fixture
def without_a_way(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Names of the decks to which no way is found with a box in the hand; may be added to."""
    decks, apply = set[str](), FakeShiftCell.apply

    def refusing(cell: FakeShiftCell, command: Command) -> None:
        if isinstance(command, PursueTarget) and cell.grip.held:
            p_WT = segments(command.target)[-1][1].p
            cell.faults.refused = int(any(is_over(deck, p_WT) for deck in decks))
        apply(cell, command)

    monkeypatch.setattr(FakeShiftCell, "apply", refusing)
    return decks


@pytest.mark.parametrize(
    ("refused", "places"),
    [
        ((PALLET,), [("b1", SECOND_PALLET), ("b2", SECOND_PALLET)]),
        (  # the second time a box that was set aside is rejected
            (PALLET, SECOND_PALLET),
            [("b1", REORIENTATION_TABLE), ("b1", REJECT_TABLE), ("b2", REORIENTATION_TABLE)],
        ),
        ((PALLET, SECOND_PALLET, REORIENTATION_TABLE), [("b1", REJECT_TABLE), ("b2", REJECT_TABLE)]),
    ],
)
def test_a_box_in_the_hand_to_whose_place_there_is_no_way_gets_another_one(
    refused, places, without_a_way
) -> None:
    without_a_way.update(refused)
    shift = run_shift([Came("tea")] * 2, [TEA])
    assert [(event.box, event.place) for event in shift.of(EventKind.PUT_DOWN)] == places
    assert shift.job.reason == "all boxes came"


def test_a_box_in_the_hand_to_which_no_way_leads_anywhere_stops_the_arm(without_a_way) -> None:
    without_a_way.update((PALLET, SECOND_PALLET, REORIENTATION_TABLE, REJECT_TABLE))
    shift = run_shift([Came("tea")], [TEA])
    assert shift.job.reason == "; ".join([REFUSED] * shift.job.reason.count(REFUSED))
    assert shift.cell.has_stopped


def test_an_empty_hand_without_a_way_stops_the_arm_also_after_its_box_got_another_place(
    without_a_way, monkeypatch: pytest.MonkeyPatch
) -> None:
    without_a_way.add(PALLET)
    apply = FakeShiftCell.apply

    def refusing(cell: FakeShiftCell, command: Command) -> None:
        if isinstance(command, PursueTarget) and not cell.grip.held:
            cell.faults.refused = int(is_over(SECOND_PALLET, cell.boxes["b1"].p))  # it has been let go there
        apply(cell, command)

    monkeypatch.setattr(FakeShiftCell, "apply", refusing)
    shift = run_shift([Came("tea")], [TEA])
    assert [(event.box, event.place) for event in shift.of(EventKind.PUT_DOWN)] == [("b1", SECOND_PALLET)]
    assert REFUSED in shift.job.reason
    assert shift.cell.has_stopped


def test_what_was_to_stand_on_a_box_that_goes_elsewhere_is_decided_on_anew() -> None:
    floor = ShiftFloor(CELL)
    items = [TEA.model_copy(update={"id": name}) for name in ("b1", "b2")]
    arrival = Arrival("b1", items[0], "", np.array(TEA.size), None)

    def planned(item: Item, z: float) -> PlannedBox:
        return PlannedBox(placed_item(item, np.array([0.0, 0.0, z]), np.array(item.size)), STRAIGHT_DOWN)

    aside = floor.set_aside(items[1])
    aside.X_WB = Pose(np.array([-2.1, -0.5, 0.8]))
    aside.finish(BoxOutcome.PLACED)
    below = floor.place(PlaceAnswer(1, NextStep.PLACE, "", "b1", PALLET, planned(items[0], 0.0)), arrival)
    above = floor.place(PlaceAnswer(2, NextStep.PLACE, "", "b2", PALLET, planned(items[1], 0.2)), arrival)
    assert floor.buffered == ()
    floor.put_elsewhere(below, planned(items[0], 0.0), SECOND_PALLET)
    assert (below.deck, above.outcome) == (SECOND_PALLET, BoxOutcome.SKIPPED)
    floor.decide_anew(above)
    assert floor.buffered == (items[1],)
    assert floor.boxes_of(REORIENTATION_TABLE)[0].X_WB is aside.X_WB


def test_a_box_that_was_to_stand_on_the_one_in_the_hand_goes_elsewhere_with_it(
    without_a_way, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fake_shift, "ON_THE_WAY", 0.0)
    monkeypatch.setattr(fake_motion, "TICKS", 8)  # slow enough to decide on the second one meanwhile
    apply = FakeShiftCell.apply

    def closing(cell: FakeShiftCell, command: Command) -> None:
        apply(cell, command)
        if isinstance(command, AskPlace) and command.question.known[0].id == "b2" and not without_a_way:
            cell.faults.lost_ways = 1
            without_a_way.add(PALLET)

    monkeypatch.setattr(FakeShiftCell, "apply", closing)
    shift = run_shift([Came("wide")] * 2, [listed("wide", (1.1, 0.75, 0.15))])
    decided = [(event.box, event.place) for event in shift.of(EventKind.DECIDED)]
    assert decided == [("b1", PALLET), ("b2", PALLET), ("b1", SECOND_PALLET), ("b2", SECOND_PALLET)]
    put_down = [(event.box, event.place) for event in shift.of(EventKind.PUT_DOWN)]
    assert put_down == [("b1", SECOND_PALLET), ("b2", SECOND_PALLET)]
    assert shift.job.reason == "all boxes came"


def nudged(monkeypatch: pytest.MonkeyPatch, by: tuple[float, float, float]) -> ShiftRunning:
    """A shift in which somebody moves the first box [m] as the second one is let go."""
    apply = FakeShiftCell.apply

    def nudging(cell: FakeShiftCell, command: Command) -> None:
        if cell.grip.held == "b2" and isinstance(command, OpenGripper):
            cell.boxes["b1"] = Pose(cell.boxes["b1"].p + np.array(by), cell.boxes["b1"].q)
        apply(cell, command)

    monkeypatch.setattr(FakeShiftCell, "apply", nudging)
    large = listed("large", (0.55, 0.39, 0.2))
    low = OnlineConfig(packer=OnlinePackerConfig(highest=0.25))
    return run_shift([Came("large")] * 3, [large], low, scans=ScanConfig(near=5.0))


def test_a_shift_goes_on_with_a_box_that_was_moved_a_little(monkeypatch) -> None:
    shift = nudged(monkeypatch, (-0.02, 0.0, 0.0))
    (moved,) = shift.of(EventKind.MOVED)
    assert moved.box == "b1"
    assert np.linalg.norm(np.array(moved.data["pose"][:3]) - shift.cell.boxes["b1"].p) < 0.003
    assert shift.job.reason == "all boxes came"


def test_a_box_that_was_moved_farther_calls_a_person(monkeypatch) -> None:
    shift = nudged(monkeypatch, (-0.06, 0.0, 0.0))
    assert shift.job.reason.startswith("seen on the pallet: box b1 stands 6")
    assert [event.box for event in shift.of(EventKind.LOST)] == ["b1"]


def test_a_shift_for_which_nothing_comes_ends() -> None:
    shift = run_shift([], [TEA], boxes=3)
    assert shift.job.reason == "no box has come for 20 s"


def test_a_lost_box_ends_the_shift_in_a_safe_stop() -> None:
    shift = run_shift([Came("tea")], [TEA], faults=Faults(lost_at="APPROACH", reason="shear 300 N"))
    assert shift.job.reason == "shear 300 N"
    assert shift.cell.has_stopped


def test_the_arm_keeps_clear_of_the_box_that_comes_next(monkeypatch: pytest.MonkeyPatch) -> None:
    tops: list[dict[str, float]] = []
    apply = FakeShiftCell.apply

    def noting(cell: FakeShiftCell, command: Command) -> None:
        if isinstance(command, PursueTarget) and len(cell.sent) == 2 and cell.grip.held != "b2":
            tops.append({o.name: float(o.X_WO.p[2] + 0.5 * o.size[2]) for o in command.target.obstacles})
        apply(cell, command)

    monkeypatch.setattr(FakeShiftCell, "apply", noting)
    assert run_shift([Came("tea")] * 2, [TEA]).job.reason == "all boxes came"
    top = CELL.picking_table.height + CELL.shift.infeed.headroom
    assert tops[0]["conveyor"] == pytest.approx(top)
    assert all("conveyor" in found or "b2" in found for found in tops)


def test_the_arm_stays_where_it_let_a_box_go_if_the_next_one_is_found_soon(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(fake_shift, "ON_THE_WAY", 0.4)
    patient, hasty = (
        run_shift([Came("tea")] * 2, [TEA], feeder=FeederConfig(linger=linger)) for linger in (1.0, 0.0)
    )
    assert patient.of(EventKind.CAME)[1].time > patient.of(EventKind.PUT_DOWN)[0].time
    assert patient.of(EventKind.PUT_DOWN)[1].time < hasty.of(EventKind.PUT_DOWN)[1].time


def test_a_shift_that_nobody_answers_where_a_box_goes_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    apply = FakeShiftCell.apply
    monkeypatch.setattr(
        FakeShiftCell, "apply", lambda cell, command: isinstance(command, AskPlace) or apply(cell, command)
    )
    assert run_shift([Came("tea")], [TEA]).job.reason == "nobody answers where the next box goes"
