"""What comes on the conveyor of a shift."""

from itertools import islice

from pack_core.palletizing.orders.box_stream import box_stream, listed_items, shipped_lists
from pack_sim.palletizing.arrivals import FAULTS, ArrivalConfig, Arrivals
from pack_sim.palletizing.infeed import ArrivingBox

ITEMS = listed_items(shipped_lists()[:1])


def first(count: int, without: frozenset[str] = frozenset()) -> tuple[list[ArrivingBox], dict[str, str]]:
    arrivals = Arrivals(ITEMS, box_stream(ITEMS, 1000), ArrivalConfig(faulty=0.3), 1000, without)
    return list(islice(arrivals, count)), dict(arrivals.faults)


def test_boxes_that_follow_are_the_same_whether_or_not_some_have_come_already() -> None:
    boxes, faults = first(40)
    left_out = frozenset(box.body.name for box in boxes[:10])
    later, later_faults = first(30, left_out)
    assert later == boxes[10:]
    assert later_faults == {name: fault for name, fault in faults.items() if name not in left_out}
    assert set(faults.values()) == set(FAULTS)
