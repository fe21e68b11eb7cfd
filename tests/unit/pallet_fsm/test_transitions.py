"""What is true of the tables, whatever the cell does."""

import pytest

from pack_core.errors import PackError
from pallet_fsm.machine import Machine
from pallet_fsm.states import ENDS, FAULTS, HOLDING, MOVING, ROWS, STEPS, State, profile_of
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
