import pytest

from pack_lockstep.blocks.execution import Execution


def execution(**changes: float | str) -> Execution:
    values = {
        "exit_reason": "arranged", "message": "", "picks": 4, "pushes": 1, "plans": 2, "error_mm": 0.2,
        "angle_deg": 0.1, "disturbance_mm": 0.0, "slip_mm": 0.05, "slip_deg": 0.0, "duration_s": 40.0,
    }  # fmt: skip
    return Execution(**{**values, **changes})


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
