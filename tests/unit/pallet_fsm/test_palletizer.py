from functools import cache
from itertools import pairwise

import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.ports import StopArm
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.report import BoxOutcome
from pallet_fsm.states import State
from pallet_fsm.transitions import Event
from unit.pallet_fsm.fake_cell import FakeCell
from unit.pallet_fsm.faults import Faults
from unit.pallet_fsm.whole_orders import given_order, misplacement, plan_as_given, run

TABLE = list(range(21))
NONE = [*range(6), *range(15, 21)]
FLIP = [*range(7), *range(14, 21)]
TRACES = {"none": NONE, "flip": FLIP, "table": TABLE}


@cache
def built(number: int, profile: str) -> tuple[Palletizer, FakeCell]:
    """An order in which nothing goes wrong, from start to end; to be looked at only."""
    return run(given_order(number), profile)


def steps(machine) -> list[int]:
    return [visit.state.value for visit in machine.machine.visits if isinstance(visit.state.value, int)]


def expected(order) -> list[int]:
    return [number for item in order.boxes for number in TRACES[item.turn.handling.value]]


@pytest.mark.parametrize("profile", ["thesis", "blended"])
@pytest.mark.parametrize("number", [3, 9, 16])
def test_every_box_goes_through_the_states_of_its_handling(number: int, profile: str) -> None:
    order = given_order(number)
    machine, _ = built(number, profile)
    assert steps(machine) == expected(order)[: len(steps(machine))]
    assert len(steps(machine)) == len(expected(order))
    assert machine.machine.state is State.DONE


def test_the_traces_have_12_14_and_21_states() -> None:
    assert (len(NONE), len(FLIP), len(TABLE)) == (12, 14, 21)


@pytest.mark.parametrize("number", range(1, 26))
def test_every_box_of_every_order_ends_where_it_was_meant_to_stand(number: int) -> None:
    machine, cell = built(number, "blended")
    report = machine.report()
    assert report.is_complete
    distance, angle = misplacement(cell, report)
    assert distance < 1e-9
    assert angle < 1e-6


def test_the_arm_stays_where_it_let_a_box_go_if_the_camera_is_about_to_answer() -> None:
    """Else it goes to its safe position and sets off from there."""
    patient, hasty = (run(given_order(3), exposure=1.0, linger=linger)[0] for linger in (1.0, 0.0))
    assert patient.report().is_complete
    assert patient.machine.visits[-1].time < hasty.machine.visits[-1].time


@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_target_counts_as_reached_when_that_was_measured(profile: str) -> None:
    """As nodes the machine hears of a measurement some time later, when the tool may be faster already."""
    punctual = built(3, profile)[0].machine.visits
    late = run(given_order(3), profile, delay=0.02)[0].machine.visits
    assert [visit.state for visit in punctual] == [visit.state for visit in late]
    times = [visit.time for visit in late]
    assert times == sorted(times)  # never before the state that was entered before
    pairs = zip(punctual, late, strict=True)
    ahead = [a.time - b.time for a, b in pairs if a.event is Event.REACHED]
    assert max(ahead) == pytest.approx(0.02)


def test_both_profiles_put_boxes_in_the_same_places() -> None:
    order = given_order(16)
    blended, thesis = (built(16, profile)[1].boxes for profile in ("blended", "thesis"))
    assert set(blended) == set(thesis) == {item.id for item in order.boxes}
    for name, X_WB in blended.items():
        assert X_WB.p == pytest.approx(thesis[name].p, abs=1e-9)


@pytest.mark.parametrize(
    ("faults", "state"),
    [
        (Faults(unseen=2), State.NO_DETECTION),
        (Faults(wrong_size=2), State.WRONG_SIZE),
        (Faults(turned=3), State.BOX_CHANGED),
        (Faults(slips=2), State.GRIP_FAILED),
        (Faults(stuck=2), State.MOTION_STUCK),
        (Faults(stuck_at_box=2), State.MOTION_STUCK),
        (Faults(lost_ways=2), State.MOTION_STUCK),
    ],
    ids=lambda value: value.name if isinstance(value, State) else "",
)
@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_fault_that_passes_costs_nothing_but_time(faults: Faults, state: State, profile: str) -> None:
    machine, cell = run(given_order(3), profile, Faults(**vars(faults)))
    report = machine.report()
    assert report.is_complete
    assert [visit.state for visit in report.faults] == [state, state]
    assert all(visit.reason for visit in report.faults)
    assert misplacement(cell, report)[0] < 1e-9


@pytest.mark.parametrize(
    ("faults", "reason"),
    [
        (Faults(unseen=3), "no contour"),
        (Faults(wrong_size=3), "20 mm too long"),
        (Faults(slips=3), "no face within reach"),
        (Faults(refused=4), "the wrist would hit box 3"),
    ],
    ids=["unseen", "wrong size", "slips", "refused"],
)
def test_a_box_that_cannot_be_had_is_skipped_with_the_reason(faults: Faults, reason: str) -> None:
    order = given_order(3)
    machine, cell = run(order, "blended", Faults(**vars(faults)))
    first, second = machine.report().boxes
    assert first.outcome is BoxOutcome.SKIPPED
    assert reason in first.reason
    assert second.outcome is BoxOutcome.PLACED
    assert first.name not in cell.boxes
    assert machine.machine.state is State.DONE


def test_boxes_that_would_rest_on_a_skipped_one_are_skipped() -> None:
    order = given_order(16)
    machine, _ = run(order, "blended", Faults(unseen=3))
    boxes = {box.name: box for box in machine.report().boxes}
    first = order.placed[0]
    above = [item.id for item in order.placed if item.rests_on(first)]
    assert above
    for name in above:
        assert boxes[name].outcome is BoxOutcome.SKIPPED
        assert first.id in boxes[name].reason


@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_move_that_is_held_on_its_way_goes_on_as_if_nothing_had_been(profile: str) -> None:
    machine, cell = run(given_order(3), profile, Faults(held=30))
    report = machine.report()
    assert cell.faults.held == 0
    assert report.is_complete
    assert not report.faults
    assert misplacement(cell, report)[0] < 1e-9


@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_grip_that_is_lost_stops_the_arm_and_says_why(profile: str) -> None:
    label = {"thesis": "TRANSFER", "blended": "transit"}[profile]
    faults = Faults(lost_at=label, reason="shear force 260.0 N above 250.0 N")
    machine, cell = run(given_order(3), profile, faults)
    report = machine.report()
    assert machine.machine.state is State.SAFE_STOP
    assert [visit.state for visit in report.faults] == [State.LIMIT_PASSED]
    assert report.reason == faults.reason
    assert report.boxes[0].outcome is BoxOutcome.LOST
    assert cell.has_stopped


@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_box_that_is_gone_without_a_reason_stops_the_arm(profile: str) -> None:
    label = {"thesis": "TRANSFER", "blended": "transit"}[profile]
    machine, cell = run(given_order(3), profile, Faults(lost_at=label))
    report = machine.report()
    assert [visit.state for visit in report.faults] == [State.BOX_LOST]
    assert report.reason == "nothing in the hand"
    assert machine.machine.state is State.SAFE_STOP
    assert cell.has_stopped


def test_motion_that_stays_stuck_stops_safely_after_its_tries() -> None:
    machine, cell = run(given_order(3), "blended", Faults(stuck=100))
    assert machine.machine.state is State.SAFE_STOP
    assert [visit.state for visit in machine.report().faults] == [State.MOTION_STUCK] * 3
    assert "no progress" in machine.report().reason
    assert cell.has_stopped


def test_a_box_in_the_hand_that_no_move_is_clear_for_stops_safely_with_every_refusal() -> None:
    machine, cell = run(given_order(3), "blended", Faults(refused_carrying=100))
    assert machine.machine.state is State.SAFE_STOP
    assert [visit.state for visit in machine.report().faults] == [State.NOT_CLEAR]
    assert machine.report().reason.count("the wrist would hit box 3") > 1
    assert cell.grip.held == machine.report().boxes[0].name


@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_grip_that_fails_at_table_b_is_tried_again_from_above(profile: str) -> None:
    order = given_order(16)
    machine, cell = run(order, profile, Faults(table_slips=2))
    report = machine.report()
    assert report.is_complete
    assert [visit.state for visit in report.faults] == [State.GRIP_FAILED] * 2
    followers = [after for before, after in pairwise(steps(machine)) if before == State.REGRASP.value]
    assert followers[:2] == [State.RISE.value] * 2
    assert misplacement(cell, report)[0] < 1e-9


def test_a_box_that_cannot_be_gripped_at_table_b_is_skipped() -> None:
    machine, cell = run(given_order(16), "blended", Faults(table_slips=3))
    skipped = [box for box in machine.report().boxes if box.outcome is BoxOutcome.SKIPPED]
    assert skipped[0].reason == "no face within reach"
    assert skipped[0].name not in cell.boxes
    assert machine.machine.state is State.DONE


@pytest.mark.parametrize(
    ("mute", "outcome", "reason"),
    [
        ("feeder", State.SAFE_STOP, "does not come"),
        ("motion", State.SAFE_STOP, "the motion does not answer"),
        ("camera", State.SAFE_STOP, "the camera does not answer"),
        ("gripper", State.DONE, "the gripper does not close"),
    ],
)
def test_a_part_of_the_cell_that_never_answers_is_named(mute: str, outcome: State, reason: str) -> None:
    machine, _ = run(given_order(3), "blended", Faults(mute=frozenset({mute})))
    assert machine.machine.state is outcome
    assert any(reason in visit.reason for visit in machine.machine.visits)
    assert not machine.report().is_complete


def test_a_halt_stops_the_arm_with_its_reason() -> None:
    order = given_order(3)
    cell = FakeCell(order)
    machine = Palletizer(
        OrderBook.of_order(order, plan_as_given(order), palletizing_cell()), palletizing_cell(),
        PalletizerConfig(), 0.0,
    )  # fmt: skip
    for _ in range(40):
        for command in machine.step(cell.observe()):
            cell.apply(command)
    machine.halt("node 'pallet_sim' is silent")
    assert StopArm() in machine.step(cell.observe())
    assert machine.report().reason == "node 'pallet_sim' is silent"
