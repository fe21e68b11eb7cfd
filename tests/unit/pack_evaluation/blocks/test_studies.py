from pack_evaluation.blocks.studies import comparison, summarize


def line(**changes: object) -> dict[str, object]:
    values = {
        "status": "FEASIBLE", "is_solved": True, "faults": [], "first_plan_ms": 5.0, "first_actions": 6,
        "total_ms": 100.0, "actions": 5,
        "lower_bound": 5, "pushes": 1, "pushed_m": 0.05, "travel_m": 1.0, "cleared": 1, "regrasps": 0,
        "execution": None,
    }  # fmt: skip
    return {**values, **changes}


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
