import pytest

from pack_lockstep.blocks.benchmark_summary import comparison, summarize
from pack_lockstep.blocks.execution import Execution


def execution(**changes: float | str) -> Execution:
    values = {
        "exit_reason": "arranged", "message": "", "picks": 4, "pushes": 1, "plans": 2, "error_mm": 0.2,
        "angle_deg": 0.1, "disturbance_mm": 0.0, "slip_mm": 0.05, "slip_deg": 0.0, "duration_s": 40.0,
    }  # fmt: skip
    return Execution(**{**values, **changes})


def line(**changes: object) -> dict[str, object]:
    values = {
        "status": "FEASIBLE", "is_solved": True, "faults": [], "first_plan_ms": 5.0, "first_actions": 6,
        "total_ms": 100.0, "actions": 5,
        "lower_bound": 5, "pushes": 1, "travel_m": 1.0, "execution": None,
    }  # fmt: skip
    return {**values, **changes}


@pytest.mark.parametrize(
    "change",
    [
        {"error_mm": 1.6},
        {"angle_deg": 1.6},
        {"disturbance_mm": 1.1},
        {"exit_reason": "no progress"},
        {"slip_mm": 0.21},
        {"slip_deg": 0.21},
    ],
)
def test_an_execution_beyond_any_of_the_bounds_does_not_count(change: dict[str, float | str]) -> None:
    assert execution().is_ok
    assert not execution(**change).is_ok


def test_an_execution_with_slip_tells_nothing() -> None:
    assert execution().is_valid
    assert not execution(slip_mm=0.21).is_valid


def test_unsolved_instances_count_and_do_not_enter_the_spreads() -> None:
    late = line(status="TIMEOUT", is_solved=False, actions=0)
    summary = summarize([line(), late, line(actions=7, faults=["collision"])])
    assert (summary["instances"], summary["solved"], summary["verified"]) == (3, 2, 1)
    assert summary["statuses"] == {"FEASIBLE": 2, "TIMEOUT": 1}
    assert summary["at_lower_bound"] == 1
    assert summary["actions"]["mean"] == 6.0
    assert summary["executed"] == 0
    assert summary["error_mm"]["max"] is None


def test_methods_stand_side_by_side() -> None:
    beam, pirs = summarize([line()]), summarize([line(actions=9, first_plan_ms=3.0)])
    table = comparison({"beam": beam, "pirs": pirs}, "four blocks")
    rows = {row[0]: row[1:] for row in table.rows}
    assert table.head == ("", "beam", "pirs")
    assert rows["actions"] == ("5.00   5.00   5.00", "9.00   9.00   9.00")
    assert rows["as short as the lower bound"] == ("1 of 1", "0 of 1")
    assert "slip in the hand [mm]" not in rows
