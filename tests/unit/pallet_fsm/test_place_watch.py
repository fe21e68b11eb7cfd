"""What the machine does when the pallet or table B is not as it was left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PALLET, palletizing_cell
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.ports import PalletObservation, ScanPlace
from pack_core.palletizing.scanner import PlaceScan
from pack_core.paths import config_path
from pack_core.rotations import POINTING_DOWN, Pose, from_yaw, multiply
from pack_perception.scans.comparison import Finding, Oddity
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig, ScanConfig
from pallet_fsm.place_watch import PlaceLook, PlaceWatch
from pallet_fsm.report import BoxOutcome, OrderReport
from pallet_fsm.states import State
from pallet_fsm.transitions import Event
from unit.pack_perception.scans.closed_form import box_on, scan_of
from unit.pallet_fsm.fake_cell import FakeCell
from unit.pallet_fsm.faults import Faults
from unit.pallet_fsm.whole_orders import given_order, plan_as_given

CELL = palletizing_cell()
SCANS = ScanConfig(near=10.0)
"""The fake arm leaps from one way-point to the next: it is looked past from wherever it hides nothing."""
PLAIN = config_path("orders", "order_03.json")
OVER_TABLE_B = config_path("scenarios", "palletizing", "by_hand.json")
"""Its first box is stood up on table B, its second one stands on that."""
STRANGER = (0.2, 0.2, 0.15)
Hand = Callable[[FakeCell, str], None]


def built(
    path: Path, hand: Hand | None = None, moment: tuple[int, State] = (0, State.DONE),
    faults: Faults | None = None, profile: str = "blended",
) -> tuple[OrderReport, FakeCell, list[str]]:  # fmt: skip
    """An order with scans, a hand that reaches in once in a state of the n-th box, and the places scanned."""
    order = load_order(path)
    name = order.boxes[moment[0]].id
    cell, scanned = FakeCell(order, faults or Faults()), list[str]()
    machine = Palletizer(
        OrderBook.of_order(order, plan_as_given(order), CELL), CELL,
        PalletizerConfig(profile=profile, scans=SCANS), 0.0,
    )  # fmt: skip
    while not machine.machine.is_over:
        visits = {(visit.box, visit.state) for visit in machine.machine.visits}
        if hand is not None and (name, moment[1]) in visits:
            hand(cell, name)
            hand = None
        for command in machine.step(cell.observe()):
            scanned += [command.place] if isinstance(command, ScanPlace) else []
            cell.apply(command)
        assert cell.time < 600.0, machine.machine.visits[-5:]
    return machine.report(), cell, scanned


def take(cell: FakeCell, name: str) -> None:
    cell.boxes.pop(name)


def turn(cell: FakeCell, name: str) -> None:
    X_WB = cell.boxes[name]
    cell.boxes[name] = Pose(X_WB.p, multiply(from_yaw(0.3), X_WB.q))


def put_on(place: str) -> Hand:
    block = next(block for block in CELL.furniture if block.name == place)

    def put(cell: FakeCell, _: str) -> None:
        x, y = block.X_WO.p[:2] + np.array([0.1, 0.1])
        cell.strangers.append(box_on(block.size[2], x, y, STRANGER))

    return put


@pytest.mark.parametrize("path", [PLAIN, OVER_TABLE_B], ids=["plain", "over table B"])
def test_an_order_that_nobody_reaches_into_is_built_and_watched(path: Path) -> None:
    report, _, scanned = built(path)
    assert report.is_complete
    assert not report.faults
    assert scanned.count(PALLET) > len(report.boxes)


@pytest.mark.parametrize(("hand", "words"), [(take, "is gone"), (turn, "17.")])
def test_a_box_that_leaves_its_place_on_the_pallet_ends_the_order_and_is_lost(hand: Hand, words: str) -> None:
    report, cell, _ = built(PLAIN, hand, (0, State.RETREAT))
    first, second = report.boxes
    assert [visit.state for visit in report.faults] == [State.PLACE_CHANGED]
    assert report.reason.startswith(f"seen on the pallet: box {first.name} ")
    assert (first.outcome, second.outcome) == (BoxOutcome.LOST, BoxOutcome.PENDING)
    assert words in first.reason
    assert cell.has_stopped


@pytest.mark.parametrize(("hand", "words"), [(take, "is gone"), (turn, "17.")])
def test_a_box_that_does_not_stay_on_table_b_is_skipped_with_what_would_stand_on_it(
    hand: Hand, words: str
) -> None:
    report, cell, scanned = built(OVER_TABLE_B, hand, (0, State.STEP_BACK), profile="thesis")
    skipped, upper = report.boxes
    assert (skipped.outcome, upper.outcome) == (BoxOutcome.SKIPPED, BoxOutcome.SKIPPED)
    assert words in skipped.reason
    assert "seen on table B" in skipped.reason
    assert skipped.name not in cell.boxes
    assert report.visits[-1].state is State.DONE
    assert "reorientation_table" in scanned


@pytest.mark.parametrize(
    ("path", "place", "where"),
    [(PLAIN, PALLET, "the pallet"), (OVER_TABLE_B, "reorientation_table", "table B")],
    ids=["pallet", "table B"],
)
def test_a_stranger_where_the_carried_box_is_to_stand_stops_the_arm_before_it_is_there(
    path: Path, place: str, where: str
) -> None:
    report, cell, _ = built(path, put_on(place), (0, State.SAFE_PICK), profile="thesis")
    assert report.reason.startswith(f"seen on {where}: something of 0.")
    assert report.boxes[0].outcome is BoxOutcome.PENDING
    assert cell.grip.held == report.boxes[0].name


def test_a_scanner_that_never_answers_is_named() -> None:
    report, _, _ = built(PLAIN, faults=Faults(mute=frozenset({"scanner"})))
    assert report.reason == "the scanner over the pallet does not answer"


def looking(tool_y: float, measured: float = 1.0, scans: tuple[PlaceScan, ...] = ()) -> PalletObservation:
    """What is known with the tool this far from the pallet's middle, measured at this time [s]."""
    cell = FakeCell(load_order(PLAIN), X_WT=Pose(np.array([-0.5, tool_y, 1.5]), POINTING_DOWN))
    seen = cell.observe()
    return replace(seen, time=measured, motion=replace(seen.motion, time=measured), scans=scans)


def asked_at(time: float) -> PlaceLook:
    """A look at the pallet for which a scan was asked for, while the arm hid nothing."""
    look = PlaceLook(PALLET, furniture_blocks()[PALLET], CELL, ScanConfig())
    assert look.ask(looking(1.15, time), tuple, None) == ScanPlace(PALLET)
    return look


def scan_with_a_stranger(time: float) -> PlaceScan:
    """The pallet with something on it that belongs to no order."""
    stranger: Obstacle = box_on(CELL.pallet.deck_height, 0.1, 0.5, STRANGER)
    return scan_of(CELL, PALLET, (*furniture_blocks().values(), stranger), time=time)


def furniture_blocks() -> dict[str, Obstacle]:
    """Tables and pallet by name."""
    return {block.name: block for block in CELL.furniture}


@pytest.mark.parametrize(
    ("measured", "is_seen"),
    [
        pytest.param([(1.05, 1.15), (1.15, 1.15)], True, id="beside the place before and after the scan"),
        pytest.param([(1.05, 1.15), (1.15, 0.95)], False, id="over the place just after the scan"),
        pytest.param([(1.08, 0.95), (1.15, 1.15)], False, id="over the place just before the scan"),
        pytest.param([(1.04, 1.15), (1.16, 1.15)], False, id="not measured for long"),
        pytest.param([(1.15, 1.15), (1.25, 0.95)], False, id="not measured since the scan was asked for"),
        pytest.param([(1.05, 1.15), (1.12, 1.15), (1.2, 0.95)], True, id="over the place later"),
    ],
)
def test_a_scan_tells_something_only_if_the_arm_is_known_to_have_hidden_nothing_at_its_time(
    measured: list[tuple[float, float]], *, is_seen: bool
) -> None:
    """Measured: time [s] and distance of the tool; the scan is asked for at 1.0 s and made at 1.1 s."""
    look, scan = asked_at(1.0), scan_with_a_stranger(1.1)
    found = [look.answer(looking(y, time, (scan,)), None) for time, y in measured]
    assert any(found) is is_seen
    assert not look.is_awaited


def test_a_scan_waits_for_a_measurement_of_the_arm_that_is_as_new() -> None:
    """Where the machine is slow, the scan may come before what tells where the arm was."""
    look, scan = asked_at(1.0), scan_with_a_stranger(1.1)
    assert not look.answer(looking(1.15, 1.05, (scan,)), None)
    assert look.is_awaited
    assert look.answer(looking(1.15, 1.11, (scan,)), None)


def test_what_is_seen_on_table_b_counts_once() -> None:
    order = given_order(16)
    book = OrderBook.of_order(order, plan_as_given(order), CELL)
    table = CELL.reorientation_table
    book.current.X_WB = Pose(np.array([*table.centre, table.height + 0.2]))
    book.current.approach = np.array([1.0, 0.0, 0.0])
    watch = PlaceWatch(SCANS, CELL, book)
    watch.observe(looking(1.15))
    assert ScanPlace("reorientation_table") in watch.commands()
    seen = replace(looking(1.15), scans=(scan_of(CELL, "reorientation_table", CELL.furniture, 1.0),))
    watch.observe(seen)
    event, reason = watch.change(State.STEP_BACK, 1.0) or (None, "")
    assert (event, reason) == (Event.BOX_CHANGED, f"seen on table B: box {book.current.name} is gone")
    assert watch.change(State.RETREAT, 1.0) is None


def test_distances_between_which_nothing_would_be_scanned_are_refused() -> None:
    with pytest.raises(ValidationError, match="hides <= clear < near"):
        ScanConfig(near=0.1)


def test_what_a_scan_says_of_a_box_that_has_left_with_its_pallet_counts_no_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The pallet may be taken away between the scan and its answer."""
    order = load_order(PLAIN)
    book = OrderBook.of_order(order, plan_as_given(order), CELL)
    book.finds_places, gone = True, book.items[-1]
    seen = FakeCell(order, Faults()).observe()
    finding = Finding(Oddity.MOVED, gone.name, np.array([0.006, 0.0]))
    monkeypatch.setattr(PlaceLook, "answer", lambda look, *_: (finding,) if look._name == PALLET else ())
    watch = PlaceWatch(SCANS, CELL, book)
    watch.observe(seen)
    assert watch.change(State.ABOVE_BOX, 0.0) is not None
    book.strike(gone)
    watch.observe(seen)
    assert watch.change(State.ABOVE_BOX, 0.0) is None
