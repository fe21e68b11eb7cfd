import pytest

from pack_bringup.recording.goal_gate import GoalGate, Sent

LATCHED, STREAM = "/description", "/numbers"
S = 1_000_000_000
"""A second [ns]."""


@pytest.fixture
def gate() -> GoalGate:
    return GoalGate([LATCHED])


def number(sent: float, topic: str = STREAM) -> Sent:
    """A message that was sent at a time of wall clock [s]; simulated time is half of it."""
    return Sent(int(sent * S), topic, int(0.5 * sent * S), f"{sent}".encode())


def sent(items: list[Sent]) -> list[float]:
    return [item.sent_ns / S for item in items]


def test_without_a_goal_nothing_is_recorded(gate: GoalGate) -> None:
    assert [item for k in range(100) for item in gate.take(number(k))] == []


def test_a_goal_is_recorded_from_2_s_before_until_2_s_after_it(gate: GoalGate) -> None:
    for k in range(100):
        gate.take(number(0.1 * k))
    recorded = gate.set_goal(True, 10 * S)
    assert sent(recorded) == pytest.approx([0.1 * k for k in range(79, 100)])
    assert sent(gate.take(number(10.1))) == [10.1]
    assert gate.set_goal(False, 11 * S) == []
    assert sent(gate.take(number(12.9))) == [12.9]
    assert gate.take(number(13.1)) == []


def test_what_is_latched_before_a_goal_is_recorded_first_and_stamped_as_its_neighbour(gate: GoalGate) -> None:
    gate.take(number(1.0, LATCHED))
    gate.take(number(99.0))
    first, second = gate.set_goal(True, 100 * S)
    assert (first.topic, first.data) == (LATCHED, b"1.0")
    assert first.time_ns == second.time_ns == int(49.5 * S)


def test_what_is_latched_is_recorded_again_only_after_it_has_changed(gate: GoalGate) -> None:
    gate.take(number(1.0, LATCHED))
    assert len(gate.set_goal(True, 100 * S)) == 1
    gate.set_goal(False, 101 * S)
    gate.take(number(200.0))
    assert sent(gate.set_goal(True, 200 * S)) == [200.0]
    gate.set_goal(False, 201 * S)
    gate.take(number(205.0, LATCHED))
    gate.take(number(299.0))
    assert [item.topic for item in gate.set_goal(True, 300 * S)] == [LATCHED, STREAM]


def test_a_goal_that_follows_at_once_leaves_nothing_out_and_repeats_nothing(gate: GoalGate) -> None:
    recorded = gate.set_goal(True, 0) + gate.take(number(1.0))
    recorded += gate.set_goal(False, 2 * S) + gate.take(number(3.0))
    recorded += gate.set_goal(True, 4 * S) + gate.take(number(9.0))
    assert sent(recorded) == [1.0, 3.0, 9.0]


def test_a_goal_shortly_after_the_last_one_s_recording_has_all_between(gate: GoalGate) -> None:
    gate.set_goal(True, 0)
    gate.set_goal(False, 1 * S)
    recorded = [item for k in range(1, 50) for item in gate.take(number(0.1 * k))]
    recorded += gate.set_goal(True, 5 * S)
    assert sent(recorded) == pytest.approx([0.1 * k for k in range(1, 50)])
