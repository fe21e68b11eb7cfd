"""What is true of the tables, whatever the cell does."""

from dataclasses import replace

import pytest

from pack_core.errors import PackError
from pallet_fsm.machine import Machine
from pallet_fsm.states import (
    BEFORE_REGRASP,
    ENDS,
    FAULTS,
    HOLDING,
    MOVING,
    ROWS,
    STEPS,
    Grip,
    State,
    profile_of,
)
from pallet_fsm.targets import TARGETS
from pallet_fsm.transitions import RESUME, TRANSITIONS, Event, Guard

NUMBERED = [row.state for row in STEPS]


def successors(state: State) -> set[State]:
    """Where a state can lead; a fault that resumes can lead back to where it came from."""
    interrupted = {row.state for row in TRANSITIONS if row.next is state}
    found = set()
    for row in TRANSITIONS:
        if row.state is state:
            found |= interrupted if row.next is RESUME else {row.next}
    return found


def reachable(start: State) -> set[State]:
    seen, rest = {start}, [start]
    while rest:
        for state in successors(rest.pop()) - seen:
            seen.add(state)
            rest.append(state)
    return seen


def test_the_21_steps_of_the_thesis_stand_in_their_order() -> None:
    assert [state.value for state in NUMBERED if isinstance(state.value, int)] == list(range(21))


def test_every_state_in_which_the_arm_moves_has_a_target_and_a_check() -> None:
    assert set(TARGETS) == set(MOVING)
    assert all(ROWS[state].check is not None for state in MOVING)


def test_the_hand_holds_a_box_from_each_grip_to_each_release() -> None:
    assert [state.value for state in HOLDING if isinstance(state.value, int)] == [
        *range(4, 9),
        *range(13, 19),
    ]


@pytest.mark.parametrize(
    ("state", "is_upright", "stop"),
    [
        (State.ABOVE_BOX, True, State.GRASP),
        (State.LIFT, True, State.DEPOSIT),
        (State.LIFT, False, State.RELEASE_TABLE),
        (State.STEP_BACK, False, State.REGRASP),
        (State.REGRASP, False, State.REGRASP),
    ],
)
def test_a_blended_move_ends_at_the_next_state_with_a_stop(state, is_upright, stop) -> None:
    machine = Machine(0.0, lambda guard: guard is Guard.IS_UPRIGHT and is_upright)
    assert machine.stop_after(state, profile_of("blended").stops_at) is stop
    assert machine.stop_after(state, profile_of("thesis").stops_at) is state


def test_every_state_can_be_reached_from_the_start() -> None:
    assert reachable(State.SPAWN) == set(State)


@pytest.mark.parametrize("state", [state for state in State if state not in ENDS], ids=lambda s: s.name)
def test_every_state_leads_to_an_end(state: State) -> None:
    assert reachable(state) & set(ENDS)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda s: s.name)
def test_every_fault_can_end_in_skipping_the_box_or_in_a_safe_stop(fault: State) -> None:
    assert successors(fault) & {State.SKIP_BOX, State.SAFE_STOP}


@pytest.mark.parametrize("state", NUMBERED, ids=lambda s: s.name)
def test_every_step_can_be_halted(state: State) -> None:
    assert Event.HALTED in {row.event for row in TRANSITIONS if row.state is state}


@pytest.mark.parametrize("state", HOLDING, ids=lambda s: s.name)
def test_losing_the_box_is_known_wherever_it_is_in_the_hand(state: State) -> None:
    events = {row.event for row in TRANSITIONS if row.state is state}
    assert {Event.BOX_LOST, Event.LIMIT_PASSED} <= events


@pytest.mark.parametrize("state", MOVING, ids=lambda s: s.name)
def test_motion_that_fails_is_known_wherever_the_arm_moves(state: State) -> None:
    events = {row.event for row in TRANSITIONS if row.state is state}
    assert {Event.MOTION_STUCK, Event.NOT_CLEAR} <= events


def test_ends_lead_nowhere() -> None:
    assert not any(row.state in ENDS for row in TRANSITIONS)


def test_rows_after_one_without_guard_would_never_be_taken() -> None:
    for row in TRANSITIONS:
        same = [r for r in TRANSITIONS if r.state is row.state and r.event is row.event]
        assert all(r.guard is not None for r in same[:-1])
        assert len({r.guard for r in same}) == len(same)


def test_there_are_two_bypasses_of_the_table() -> None:
    places = {state: place for place, state in enumerate(NUMBERED)}
    jumps = {
        (row.state, row.next)
        for row in TRANSITIONS
        if row.next in places and row.state in places and places[row.next] > places[row.state] + 1
    }
    assert jumps == {(State.SAFE_PICK, State.TRANSFER), (State.SAFE_TABLE, State.LEAVE_TABLE)}


def test_an_event_that_a_state_does_not_know_is_an_error_that_names_those_it_knows() -> None:
    machine = Machine(0.0, lambda guard: True)
    with pytest.raises(PackError, match=r"0 spawn.*target reached.*box spawned"):
        machine.fire(Event.REACHED, 1.0)


def test_a_fault_that_is_overcome_leads_back_to_where_it_came_from() -> None:
    machine = Machine(0.0, lambda guard: guard is Guard.HAS_TRIES)
    for event in (Event.SPAWNED, Event.DETECTED, Event.MOTION_STUCK, Event.ASSESSED):
        machine.fire(event, 1.0, reason="no progress" if event is Event.MOTION_STUCK else "")
    assert machine.state is State.ABOVE_BOX
    assert machine.reason == "no progress"


def done_in(state: State) -> Event:
    """What happens in a step when all goes well."""
    special = {State.SPAWN: Event.SPAWNED, State.DETECT: Event.DETECTED}
    by_grip = {Grip.CLOSE: Event.GRIPPED, Grip.OPEN: Event.RELEASED}
    return special.get(state, by_grip.get(ROWS[state].grip, Event.REACHED))


@pytest.mark.parametrize(
    ("handling", "numbers"),
    [
        ({Guard.IS_UPRIGHT}, [*range(6), *range(15, 21)]),
        ({Guard.IS_FLIP}, [*range(7), *range(14, 21)]),
        (set(), list(range(21))),
    ],
    ids=["none", "flip", "turn"],
)
@pytest.mark.parametrize(
    ("more", "after"), [({Guard.HAS_BOXES}, State.SPAWN), (set(), State.DONE)], ids=["boxes left", "last box"]
)
def test_a_box_that_makes_no_trouble_goes_through_the_states_of_its_handling(
    handling, numbers, more, after
) -> None:
    machine = Machine(0.0, lambda guard: guard in handling | more)
    for time in range(1, len(numbers) + 1):
        machine.fire(done_in(machine.state), float(time))
        assert machine.since == time
    assert [visit.state.value for visit in machine.visits[:-1]] == numbers
    assert machine.state is after
    assert machine.is_over is (after is State.DONE)
    assert machine.reason == ""


def in_fault(fault: State, *holds: Guard) -> State:
    """Where a fault leads while these guards hold."""
    for row in TRANSITIONS:
        if row.next is fault:
            machine = Machine(0.0, lambda guard: guard in holds)
            machine.visits.append(replace(machine.visits[-1], state=row.state))
            assert machine.fire(row.event, 1.0, reason="it failed") is fault
            return machine.fire(Event.ASSESSED, 2.0)
    raise AssertionError(f"nothing leads to {fault.name}")


@pytest.mark.parametrize("fault", [State.NO_DETECTION, State.WRONG_SIZE], ids=lambda s: s.name)
def test_a_box_that_is_not_seen_well_is_looked_for_again_while_tries_are_left(fault: State) -> None:
    assert in_fault(fault, Guard.HAS_TRIES) is State.DETECT
    assert in_fault(fault) is State.SKIP_BOX


@pytest.mark.parametrize("fault", [State.BOX_CHANGED, State.GRIP_FAILED], ids=lambda s: s.name)
def test_before_a_box_is_tried_anew_the_arm_backs_off_and_without_tries_it_is_skipped(fault: State) -> None:
    on_table = State.RISE if fault is State.GRIP_FAILED else State.SKIP_BOX
    assert in_fault(fault, Guard.HAS_TRIES) is State.RETREAT
    assert in_fault(fault, Guard.HAS_TRIES, Guard.IS_ON_TABLE) is on_table
    assert in_fault(fault, Guard.HAS_NO_TRIES) is State.SKIP_BOX
    assert in_fault(fault, Guard.HAS_NO_TRIES, Guard.IS_ON_TABLE) is State.SKIP_BOX


def test_motion_that_is_stuck_is_tried_again_after_a_look_where_one_is_needed() -> None:
    assert in_fault(State.MOTION_STUCK, Guard.HAS_NO_TRIES, Guard.IS_UNSEEN) is State.SAFE_STOP
    assert in_fault(State.MOTION_STUCK, Guard.HAS_TRIES, Guard.IS_UNSEEN) is State.RETREAT
    assert in_fault(State.MOTION_STUCK, Guard.HAS_TRIES) in MOVING


def test_without_a_clear_way_the_arm_stops_with_a_box_in_hand_or_nothing_to_skip() -> None:
    assert in_fault(State.NOT_CLEAR, Guard.IS_HOLDING) is State.SAFE_STOP
    assert in_fault(State.NOT_CLEAR, Guard.IS_FINISHED) is State.SAFE_STOP
    assert in_fault(State.NOT_CLEAR) is State.SKIP_BOX


@pytest.mark.parametrize(
    "fault", [State.PLACE_CHANGED, State.BOX_LOST, State.LIMIT_PASSED], ids=lambda s: s.name
)
def test_a_changed_place_a_lost_box_and_a_passed_limit_end_in_a_safe_stop_whatever_else_holds(
    fault: State,
) -> None:
    assert in_fault(fault) is in_fault(fault, *Guard) is State.SAFE_STOP


def test_a_skipped_box_is_left_by_a_retreat() -> None:
    assert successors(State.SKIP_BOX) == {State.RETREAT}


def knowing(event: Event) -> set[State]:
    return {row.state for row in TRANSITIONS if row.event is event}


def test_a_grip_can_fail_wherever_the_gripper_closes() -> None:
    assert knowing(Event.GRIP_FAILED) == {row.state for row in STEPS if row.grip is Grip.CLOSE}


def test_a_box_can_change_from_where_the_arm_comes_over_it_until_it_is_gripped() -> None:
    assert knowing(Event.BOX_CHANGED) == {State.ABOVE_BOX, State.GRASP, *BEFORE_REGRASP}


def test_a_place_can_change_in_every_step() -> None:
    assert knowing(Event.PLACE_CHANGED) == {*NUMBERED, State.PUT_BACK}


def test_a_load_can_have_another_weight_wherever_a_box_is_carried() -> None:
    assert knowing(Event.WRONG_WEIGHT) == set(HOLDING) - {State.PUT_BACK}


def test_the_reason_is_that_of_the_last_fault() -> None:
    machine = Machine(0.0, lambda guard: guard is Guard.HAS_TRIES)
    machine.fire(Event.SPAWNED, 1.0)
    for fault in (Event.NO_DETECTION, Event.WRONG_SIZE):
        machine.fire(fault, 2.0, reason=fault.value)
        machine.fire(Event.ASSESSED, 3.0)
    assert machine.reason == "wrong size"
