"""What somebody does to the palletizing cell by hand, in each state of an order of two boxes.

The lower box is stood up on table B, so that it goes through all states; the upper one stands on it.
"""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.errors import PackError
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.run import PalletRun
from pack_lockstep.hands import HandCase, HandReport, Hands
from pack_lockstep.palletizing.benchmark import plan_order
from pack_lockstep.palletizing.hand_deeds import (
    BESIDE_IT,
    CAMERA,
    DEEDS,
    EXCHANGED,
    IN_PICTURES,
    IN_PLACE,
    ON_TABLE_B,
    REMOVED,
    SHIFTED,
    TURNED,
    VACUUM,
    PalletDeed,
    PalletReach,
)
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import set_up
from pallet_fsm.states import FAULTS, State

ORDER = config_path("scenarios", "palletizing", "by_hand.json")
INTO = 0.1
"""Time in a state after which the hand reaches in, and between its tries where there is no room [s]."""
_MOVED = (REMOVED, TURNED, SHIFTED)
_HELD = (REMOVED, VACUUM)
LOWER, UPPER = "lower", "upper"
MOMENTS: dict[str, tuple[str, State, str, tuple[str, ...]]] = {
    "detect": (LOWER, State.DETECT, LOWER, (*_MOVED, EXCHANGED, BESIDE_IT, CAMERA)),
    "above box": (LOWER, State.ABOVE_BOX, LOWER, (*_MOVED, EXCHANGED, BESIDE_IT, CAMERA)),
    "grasp, after the second look": (LOWER, State.GRASP, LOWER, (REMOVED, TURNED, SHIFTED)),
    "lift": (LOWER, State.LIFT, LOWER, _HELD),
    "rotate": (LOWER, State.ROTATE, LOWER, (*_HELD, ON_TABLE_B)),
    "release table": (LOWER, State.RELEASE_TABLE, LOWER, _HELD),
    "step back": (LOWER, State.STEP_BACK, LOWER, _MOVED),
    "above table": (LOWER, State.ABOVE_TABLE, LOWER, (*_MOVED, EXCHANGED)),
    "regrasp": (LOWER, State.REGRASP, LOWER, (REMOVED, TURNED)),
    "lift table": (LOWER, State.LIFT_TABLE, LOWER, _HELD),
    "above pallet": (LOWER, State.ABOVE_PALLET, LOWER, (*_HELD, IN_PLACE)),
    "pre deposit": (LOWER, State.PRE_DEPOSIT, LOWER, _HELD),
    "deposit": (LOWER, State.DEPOSIT, LOWER, _HELD),
    "deposit, the next box": (LOWER, State.DEPOSIT, UPPER, (*_MOVED, EXCHANGED, CAMERA)),
    "retreat": (LOWER, State.RETREAT, LOWER, (*_MOVED, EXCHANGED)),
    "retreat, the next box": (LOWER, State.RETREAT, UPPER, (*_MOVED, EXCHANGED)),
    "above the next box": (UPPER, State.ABOVE_BOX, UPPER, (*_MOVED, EXCHANGED, BESIDE_IT, CAMERA)),
    "grasp, of the upper box": (UPPER, State.GRASP, UPPER, (TURNED, SHIFTED)),
    "above pallet, the stack": (UPPER, State.ABOVE_PALLET, LOWER, (REMOVED, SHIFTED)),
    "pre deposit, the stack": (UPPER, State.PRE_DEPOSIT, LOWER, (REMOVED, SHIFTED)),
    "retreat, the stack": (UPPER, State.RETREAT, UPPER, _MOVED),
    "return, the stack": (UPPER, State.RETURN, UPPER, (REMOVED,)),
}
"""By name: the box in work and its state, the box that is meant, and what is done."""


def run_case(case: HandCase, seed: int) -> HandReport:
    """Build the order, and do by hand what the case says."""
    worked, state, meant, _ = MOMENTS[case.when]
    setup = set_up(profile="blended", motion="shipped", preset="rigid", vision=case.what in IN_PICTURES)
    order = load_order(ORDER, setup.cell)
    cell = PalletLockstep(setup.cell, order, plan_order(order, setup.layout), setup.config, seed)
    hand = PalletHand(DEEDS[case.what], PalletReach(cell, meant), (worked, state))
    run = cell.run(hand)
    return _report(case, cell, run, hand)


@dataclass
class PalletHand:
    """Waits for its moment, and does its deed once; `problem` is empty after that."""

    deed: PalletDeed
    reach: PalletReach
    moment: tuple[str, State]
    time: float = float("nan")
    problem: str = "the state was not reached"
    _next: float = 0.0

    def __call__(self, tick: Tick) -> None:
        """Look whether the moment has come; where there is no room yet, try again a little later."""
        visit = self.reach.cell.palletizer.machine.visits[-1]
        is_time = (visit.box, visit.state) == self.moment and tick.time > visit.time + INTO
        if not self.problem or not is_time or tick.time < self._next:
            return
        try:
            self.deed(self.reach)
            self.time, self.problem = tick.time, ""
        except PackError as error:
            self._next, self.problem = tick.time + INTO, str(error)


def _report(case: HandCase, cell: PalletLockstep, run: PalletRun, hand: PalletHand) -> HandReport:
    time, problem = hand.time, hand.problem
    report, measures = cell.palletizer.report(), measure_order(run)
    said = [visit for visit in report.visits if visit.reason and visit.time >= time]
    faults = [visit for visit in said if visit.state in FAULTS or visit.state is State.SAFE_STOP]
    placed = [box for box in measures.boxes if box.outcome == "placed" and box.name in cell_boxes(cell)]
    fates = [f"{box.name} {box.outcome}" for box in report.boxes]
    return HandReport(
        case.name, case.what, case.when,
        noticed=tuple(dict.fromkeys(visit.reason for visit in faults)),
        noticed_after=faults[0].time - time if faults else float("nan"),
        ended=("stopped: " if run.reason else "") + ", ".join(fates),
        in_place=f"{sum(box.is_ok for box in placed)} of {len(report.boxes)}",
        error_mm=max((box.error_mm or 0.0 for box in placed), default=float("nan")),
        angle_deg=max((box.angle_deg or 0.0 for box in placed), default=float("nan")),
        touches=measures.touches, problem=problem,
    )  # fmt: skip


def cell_boxes(cell: PalletLockstep) -> set[str]:
    """Names of the boxes that are in the cell."""
    return {box.name for box in cell.simulator.boxes}


HANDS = Hands(
    tuple(HandCase(what, when) for when, (*_, deeds) in MOMENTS.items() for what in deeds), run_case,
    "worst: of the boxes that the cell counts as placed and that are there, against their planned poses",
)  # fmt: skip
