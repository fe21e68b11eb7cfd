"""What the machine does about a load of another weight, in the cell without physics."""

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from pack_core.palletizing.cell import REJECT_TABLE
from pallet_fsm import load_watch
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import WeighingConfig
from pallet_fsm.report import BoxOutcome
from pallet_fsm.states import State
from unit.pallet_fsm.whole_orders import given_order, misplacement, run


class FakeScale:
    """Says at once what each grip shall weigh, in their sequence; after the last one what boxes do weigh."""

    seconds = 1.0

    def __init__(self, wrong: list[float], told: list[float]) -> None:
        self._wrong, self._told = wrong, told
        self.mass: float | None = None

    def put_on(self, dims, X_TB) -> None:
        self.mass = self._wrong.pop(0) if self._wrong else self._told[0]

    def take_off(self) -> None:
        self.mass = None

    def note(self, sample) -> None:
        raise AssertionError("the fake cell measures no torques")


@pytest.fixture
def weigh(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Have the first grips weigh what is given [kg], and all others what the order says."""

    def use(*wrong: float) -> None:
        told = [0.0]
        monkeypatch.setattr(load_watch, "HandScale", lambda cell: FakeScale(list(wrong), told))
        take = load_watch.LoadWatch.take

        def taken(self, item: WorkItem) -> None:
            told[0] = item.box.weight
            take(self, item)

        monkeypatch.setattr(load_watch.LoadWatch, "take", taken)

    return use


def states(machine) -> list[State]:
    return [visit.state for visit in machine.machine.visits]


@pytest.mark.parametrize("profile", ["thesis", "blended"])
def test_a_box_that_is_not_in_the_hand_is_gripped_again(weigh, profile: str) -> None:
    weigh(0.1, 0.2)
    order = given_order(3)
    machine, cell = run(order, profile)
    assert machine.report().is_complete
    assert states(machine).count(State.PUT_BACK) == 2
    assert "the hand is empty: 0.1 kg instead of" in machine.report().faults[0].reason
    assert misplacement(cell, machine.report())[0] < 1e-9


def test_a_box_that_keeps_another_weight_is_left_out_and_the_order_goes_on(weigh) -> None:
    order = given_order(3)
    weigh(*(3 * [2.0 * order.boxes[0].weight + 5.0]))
    report = run(order)[0].report()
    outcomes = [box.outcome for box in report.boxes]
    assert BoxOutcome.SKIPPED in outcomes
    assert BoxOutcome.PLACED in outcomes
    skipped = next(box for box in report.boxes if box.outcome is BoxOutcome.SKIPPED)
    assert "the hand holds" in skipped.reason
    assert report.is_complete is False
    assert report.reason == ""


def test_a_box_that_stays_behind_on_table_b_stops_the_arm(weigh) -> None:
    order = given_order(16)
    turned = next(box for box in order.boxes if box.turn.handling.value == "table")
    before = order.boxes.index(turned)
    assert all(box.turn.handling.value != "table" for box in order.boxes[:before])
    weigh(*(box.weight for box in order.boxes[: before + 1]), 0.0)
    machine, cell = run(order)
    assert states(machine)[-2:] == [State.WRONG_WEIGHT, State.SAFE_STOP]
    assert cell.has_stopped


def test_what_was_weighed_is_in_the_report(weigh) -> None:
    weigh()
    report = run(given_order(3))[0].report()
    assert [box["weighed"] for box in report.to_json()["boxes"]] == [box.mass for box in report.boxes]


@pytest.mark.parametrize("window", [0.0, 0.12])
def test_joints_are_noted_unless_weighing_is_turned_off(monkeypatch, window: float) -> None:
    noted: list[object] = []
    monkeypatch.setattr(load_watch, "HandScale", lambda cell: SimpleNamespace(note=noted.append))
    seen = SimpleNamespace(samples=(object(), object()))
    load_watch.LoadWatch(WeighingConfig(window=window), None).observe(seen)
    assert noted == (list(seen.samples) if window else [])


@pytest.mark.parametrize(
    ("window", "samples", "is_weighing"), [(0.12, (1.0,), True), (0.12, (), False), (0.0, (1.0,), False)]
)
def test_a_box_is_being_weighed_from_the_grip_until_its_weight_is_known(
    monkeypatch, window: float, samples: tuple[float, ...], is_weighing: bool
) -> None:
    """Meanwhile it may have to go back, and the next one does not come; without torques it never is."""
    scale = SimpleNamespace(note=lambda _: None, put_on=lambda *_: None, mass=None, seconds=1.0)
    monkeypatch.setattr(load_watch, "HandScale", lambda cell: scale)
    watch = load_watch.LoadWatch(WeighingConfig(window=window), None)
    watch.observe(SimpleNamespace(samples=samples))
    assert not watch.is_weighing
    watch.take(WorkItem(given_order(3).boxes[0], None, X_TB=object()))
    assert watch.fault() == ""
    assert watch.is_weighing is is_weighing
    scale.mass = given_order(3).boxes[0].weight
    assert watch.fault() == ""
    assert not watch.is_weighing


def test_nobody_knows_what_a_rejected_box_should_weigh(weigh) -> None:
    weigh(3.0)
    box = given_order(3).boxes[0].model_copy(update={"weight": 10.0})
    item = WorkItem(box, None, deck=REJECT_TABLE, X_TB=object())
    watch = load_watch.LoadWatch(WeighingConfig(), None)
    watch.take(item)
    assert watch.fault() == ""
    assert item.weighed == 3.0


@pytest.mark.parametrize(("mass", "is_right"), [(8.6, True), (11.4, True), (8.4, False), (11.6, False)])
def test_a_tenth_and_half_a_kilogram_are_allowed(weigh, mass: float, is_right: bool) -> None:
    weigh(mass)
    order = given_order(3)
    box = order.boxes[0].model_copy(update={"weight": 10.0})
    item = WorkItem(box, None, X_TB=object())
    watch = load_watch.LoadWatch(WeighingConfig(), None)
    watch.take(item)
    assert (watch.fault() == "") is is_right
    assert watch.fault() == ""
    assert item.weighed == mass
