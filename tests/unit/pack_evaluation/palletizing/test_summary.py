from dataclasses import replace

import pytest

from pack_evaluation.palletizing.studies import comparison
from pack_evaluation.palletizing.summary import OrderTrial, cycles, summarize_orders


def box(error_mm: float | None = 1.0, handling: str = "none", cycle_s: float | None = 8.0) -> dict:
    return {
        "name": "a", "handling": handling, "outcome": "placed", "is_ok": error_mm is not None,
        "error_mm": error_mm, "angle_deg": 0.1, "cycle_s": cycle_s, "coaxial_N": 1.0, "shear_N": 1.0,
        "moment_Nm": 1.0,
    }  # fmt: skip


def trial(
    order: str, seed: int, boxes: list[dict], duration_s: float = 10.0, **changes: object
) -> OrderTrial:
    measures = {
        "is_complete": all(item["is_ok"] for item in boxes), "boxes": boxes, "position_mm": (0.1, 0.5),
        "orientation_deg": (0.01, 0.05), "goal_mm": (0.1, 0.2), "shift_mm": [0.1], "drops": 0, "touches": 0,
        "interruptions": 2, "faults": [], "duration_s": duration_s,
    }  # fmt: skip
    return OrderTrial(order, seed, measures | changes, hold_mm=2.0)


def test_an_order_is_complete_only_if_it_is_with_every_seed() -> None:
    good, bad = [box()], [box(None)]
    found = summarize_orders([trial("o1", 0, good), trial("o1", 1, bad), trial("o2", 0, good)])
    assert (found["orders"], found["orders_complete"]) == (2, 1)
    assert (found["runs"], found["runs_complete"]) == (3, 2)
    assert (found["boxes"], found["boxes_ok"]) == (3, 2)
    assert found["interruptions"] == 6


def test_mean_tracking_is_weighted_by_time_and_the_largest_is_the_largest() -> None:
    short = trial("o1", 0, [box()], 10.0, position_mm=(0.4, 0.5))
    long = trial("o2", 0, [box()], 30.0, position_mm=(0.2, 0.9))
    assert summarize_orders([short, long])["tracking_position_mm"] == pytest.approx(
        {"mean": 0.25, "max": 0.9}
    )


def test_cycle_times_are_means_over_boxes_by_handling() -> None:
    found = cycles([box(handling="none", cycle_s=7.0), box(handling="flip", cycle_s=9.0),
                    box(handling="table", cycle_s=14.0), box(handling="table", cycle_s=None)])  # fmt: skip
    assert found["none_or_flip"] == pytest.approx(8.0)
    assert found["table"] == pytest.approx(14.0)
    assert found["mean"] == pytest.approx(10.0)
    assert found["boxes_per_hour"] == pytest.approx(360.0)


def test_what_calibrations_expect_is_a_mean_over_boxes_beside_what_was_measured() -> None:
    known = replace(trial("o1", 0, [box()] * 3), expected_mm={"mean": 0.2, "p95": 0.4})
    other = replace(trial("o1", 1, [box()]), expected_mm={"mean": 0.6, "p95": 0.8})
    found = summarize_orders([known, other, trial("o2", 0, [box()] * 5)])
    assert found["expected_error_mm"] == pytest.approx({"mean": 0.3, "p95": 0.5})
    rows = {row[0]: row[1] for row in comparison({"real": found}).rows}
    assert rows["the same, as the calibration expects [mm]"] == "0.300   0.500   -"


def test_the_true_path_of_cells_that_have_one_is_summarized_and_left_out_of_the_table_of_the_others() -> None:
    real, ideal = trial("o1", 0, [box()], true_position_mm=(0.2, 0.7)), trial("o2", 0, [box()])
    found = summarize_orders([real, ideal])
    assert found["true_position_mm"] == {"mean": 0.2, "max": 0.7}
    assert "true tool off its path [mm]" in {row[0] for row in comparison({"real": found}).rows}
    found = summarize_orders([ideal])
    assert found["true_position_mm"] is None
    assert "true tool off its path [mm]" not in {row[0] for row in comparison({"ideal": found}).rows}
