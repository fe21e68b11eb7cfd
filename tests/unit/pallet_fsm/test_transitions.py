"""What is true of the tables, whatever the cell does."""

import pytest

from pack_core.errors import PackError
from pallet_fsm.machine import Machine
from pallet_fsm.states import ENDS, FAULTS, STEPS, State
from pallet_fsm.transitions import HOLDING, MOVING, RESUME, TRANSITIONS, Event

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


def test_there_are_21_steps_numbered_as_in_the_thesis() -> None:
    assert [state.value for state in NUMBERED] == list(range(21))


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
    jumps = {
        (row.state.value, row.next.value)
        for row in TRANSITIONS
        if row.next in NUMBERED and row.state in NUMBERED and row.next.value > row.state.value + 1
    }
    assert jumps == {(5, 15), (6, 14)}


def test_an_event_that_a_state_does_not_know_is_an_error_that_names_those_it_knows() -> None:
    machine = Machine(0.0, lambda guard: True)
    with pytest.raises(PackError, match=r"0 spawn.*target reached.*box spawned"):
        machine.fire(Event.REACHED, 1.0)


def test_a_fault_that_is_overcome_leads_back_to_where_it_came_from() -> None:
    machine = Machine(0.0, lambda guard: True)
    for event in (Event.SPAWNED, Event.DETECTED, Event.MOTION_STUCK, Event.ASSESSED):
        machine.fire(event, 1.0, reason="no progress" if event is Event.MOTION_STUCK else "")
    assert machine.state is State.ABOVE_BOX
    assert machine.reason == "no progress"
