"""An order of which nothing was built counts as not complete, and for nothing else."""

from dataclasses import asdict

from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_evaluation.palletizing.measures import measure_order, measures_of_unbuilt
from pack_evaluation.palletizing.summary import OrderTrial, summarize_orders
from unit.pack_evaluation.palletizing.known_run import a_run

ORDER = load_order(config_path("orders", "order_03.json"))
UNBUILT = OrderTrial("order_03", 0, asdict(measures_of_unbuilt(ORDER, "no layout: too full")), None)
BUILT = OrderTrial("test", 0, asdict(measure_order(a_run())), 1.0)


def test_all_its_boxes_are_missing_and_the_reason_is_a_fault() -> None:
    found = summarize_orders([UNBUILT])
    assert (found["runs"], found["runs_complete"]) == (1, 0)
    assert (found["boxes"], found["boxes_ok"]) == (len(ORDER.boxes), 0)
    assert found["per_order"]["order_03"]["faults"] == ["no layout: too full"]
    assert found["tracking_position_mm"] is None


def test_it_does_not_change_the_means_of_those_that_were_built() -> None:
    alone, both = summarize_orders([BUILT]), summarize_orders([BUILT, UNBUILT])
    for key in ("tracking_position_mm", "tracking_orientation_deg", "placed_error_mm", "cycle_s"):
        assert both[key] == alone[key]
    assert both["runs_complete"] == alone["runs_complete"]
