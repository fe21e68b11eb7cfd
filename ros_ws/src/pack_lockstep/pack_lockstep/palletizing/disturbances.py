"""What is done to boxes, gripper and camera of the palletizing cell, in each state of an order of two boxes.

The lower box is stood up on table B, so that it goes through all states; the upper one stands on it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pack_core.errors import PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.rotations import Array, Pose, from_yaw, multiply
from pack_evaluation.palletizing.measures import measure_order
from pack_evaluation.palletizing.run import PalletRun
from pack_lockstep.disturbances import Disturbance, DisturbanceReport, DisturbanceTable
from pack_lockstep.palletizing.benchmark import plan_order
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import set_up
from pallet_fsm.states import FAULTS, State

ORDER = config_path("scenarios", "palletizing", "by_hand.json")
INTO = 0.1
"""Time in a state after which a change is made, and between two tries where there is no room [s]."""
TURN, SHIFT = np.deg2rad(20.0), np.array([0.06, 0.0, 0.0])
"""By which a box is turned and shifted [rad, m]: more than the gripper forgives."""
BESIDE = np.array([0.0, -0.4, 0.0])
"""From a box on table A to where another one is put beside it [m]."""
OTHER = (0.2, 0.15, 0.12)
"""Size of a box that does not belong to the order [m]."""


@dataclass
class PalletSite:
    """Where a change is made: the cell at work, and the box that is meant."""

    cell: PalletLockstep
    box: str

    @property
    def body(self) -> BoxBody:
        """The box as it is in the simulator."""
        return next(box for box in self.cell.simulator.boxes if box.name == self.box)

    @property
    def X_WB(self) -> Pose:
        """Where it truly is."""
        return self.cell.simulator.truth().objects[self.box].X_WO

    def move(self, X_WB: Pose) -> None:
        """Put the box somewhere else; raises PackError where there is no room, and leaves it where it was."""
        body, before, simulator = self.body, self.X_WB, self.cell.simulator
        simulator.remove(self.box)
        try:
            simulator.spawn(body, X_WB)
        except PackError:
            simulator.spawn(body, before)
            raise


PalletChange = Callable[[PalletSite], None]


def _remove(site: PalletSite) -> None:
    site.cell.simulator.remove(site.box)


def _turn(site: PalletSite) -> None:
    X_WB = site.X_WB
    site.move(Pose(X_WB.p, multiply(from_yaw(TURN), X_WB.q)))


def _shift(site: PalletSite) -> None:
    X_WB = site.X_WB
    site.move(Pose(X_WB.p + SHIFT, X_WB.q))


def _exchange(site: PalletSite) -> None:
    """Put a box of another size where the right one stood."""
    X_WB, body = site.X_WB, site.body
    x, y, z = body.size
    other = BoxBody("another box", (x - 0.06, y - 0.04, z), body.mass)
    site.cell.simulator.remove(site.box)
    site.cell.simulator.spawn(other, X_WB)


def _add_beside(site: PalletSite) -> None:
    height = site.cell.simulator.nominal.picking_table.height
    _add(site, np.array([*(site.X_WB.p + BESIDE)[:2], height]))


def _add_on_table_b(site: PalletSite) -> None:
    table = site.cell.simulator.nominal.reorientation_table
    corner = np.array(table.centre) - 0.5 * np.array(table.size)
    _add(site, np.array([*(corner + 0.2), table.height]))


def _add_at_place(site: PalletSite) -> None:
    planned = next(item for item in site.cell.palletizer.report().boxes if item.name == site.box)
    x, y = planned.X_WB.p[:2]
    _add(site, np.array([x, y, site.cell.simulator.nominal.pallet.deck_height]))


def _add(site: PalletSite, foot_W: Array) -> None:
    body = BoxBody("another box", OTHER, 2.0)
    site.cell.simulator.spawn(body, Pose(foot_W + np.array([0.0, 0.0, 0.5 * OTHER[2]])))


def _lose_vacuum(site: PalletSite) -> None:
    site.cell.simulator.gripper.fail("the vacuum was lost")


def _slip(site: PalletSite) -> None:
    site.cell.simulator.gripper.slip()


def _empty(site: PalletSite) -> None:
    _change_mass(site, 0.4)


def _double(site: PalletSite) -> None:
    _change_mass(site, 2.0)


def _change_mass(site: PalletSite, times: float) -> None:
    """Put a box that weighs so many times as much in the place of the right one."""
    X_WB, body = site.X_WB, site.body
    site.cell.simulator.remove(site.box)
    site.cell.simulator.spawn(BoxBody(body.name, body.size, times * body.mass), X_WB)


def _silence_camera(site: PalletSite) -> None:
    site.cell.stepped.camera_is_silent = True


CHANGES: dict[str, PalletChange] = {
    "box removed": _remove,
    "box turned by 20 degrees": _turn,
    "box shifted by 60 mm": _shift,
    "box exchanged for a smaller one": _exchange,
    "another box put beside it": _add_beside,
    "another box put on table B": _add_on_table_b,
    "another box put in its place": _add_at_place,
    "vacuum lost": _lose_vacuum,
    "vacuum lost unnoticed": _slip,
    "box nearly empty": _empty,
    "box twice as heavy": _double,
    "camera silent": _silence_camera,
}
(
    REMOVED, TURNED, SHIFTED, EXCHANGED, BESIDE_IT, ON_TABLE_B, IN_PLACE, VACUUM, SLIP, EMPTY, DOUBLE, CAMERA,
) = CHANGES  # fmt: skip
IN_PICTURES = (EXCHANGED, BESIDE_IT)
"""Changes that only a picture shows; in all other cases boxes are found by their true poses with noise."""

_MOVED = (REMOVED, TURNED, SHIFTED)
_HELD = (REMOVED, VACUUM)
LOWER, UPPER = "lower", "upper"
MOMENTS: dict[str, tuple[str, State, str, tuple[str, ...]]] = {
    "detect": (LOWER, State.DETECT, LOWER, (*_MOVED, EXCHANGED, BESIDE_IT, EMPTY, DOUBLE, CAMERA)),
    "above box": (LOWER, State.ABOVE_BOX, LOWER, (*_MOVED, EXCHANGED, BESIDE_IT, CAMERA)),
    "grasp, after the second look": (LOWER, State.GRASP, LOWER, (REMOVED, TURNED, SHIFTED)),
    "lift": (LOWER, State.LIFT, LOWER, (*_HELD, SLIP)),
    "rotate": (LOWER, State.ROTATE, LOWER, (*_HELD, ON_TABLE_B)),
    "release table": (LOWER, State.RELEASE_TABLE, LOWER, _HELD),
    "step back": (LOWER, State.STEP_BACK, LOWER, _MOVED),
    "above table": (LOWER, State.ABOVE_TABLE, LOWER, (*_MOVED, EXCHANGED)),
    "regrasp": (LOWER, State.REGRASP, LOWER, (REMOVED, TURNED)),
    "lift table": (LOWER, State.LIFT_TABLE, LOWER, (*_HELD, SLIP)),
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


def run_case(case: Disturbance, seed: int) -> DisturbanceReport:
    """Build the order, and disturb it as the case says."""
    worked, state, meant, _ = MOMENTS[case.when]
    setup = set_up(vision=case.what in IN_PICTURES)
    order = load_order(ORDER, setup.cell)
    cell = PalletLockstep(setup.cell, order, plan_order(order, setup.layout), setup.config, seed)
    disturber = PalletDisturber(CHANGES[case.what], PalletSite(cell, meant), (worked, state))
    run = cell.run(disturber)
    return _report(case, cell, run, disturber)


@dataclass
class PalletDisturber:
    """Waits for its moment, and makes its change once; `problem` is empty after that."""

    change: PalletChange
    site: PalletSite
    moment: tuple[str, State]
    time: float = float("nan")
    problem: str = "the state was not reached"
    _next: float = 0.0

    def __call__(self, tick: Tick) -> None:
        """Look whether the moment has come; where there is no room yet, try again a little later."""
        visit = self.site.cell.palletizer.machine.visits[-1]
        is_time = (visit.box, visit.state) == self.moment and tick.time > visit.time + INTO
        if not self.problem or not is_time or tick.time < self._next:
            return
        try:
            self.change(self.site)
            self.time, self.problem = tick.time, ""
        except PackError as error:
            self._next, self.problem = tick.time + INTO, str(error)


def _report(
    case: Disturbance, cell: PalletLockstep, run: PalletRun, disturber: PalletDisturber
) -> DisturbanceReport:
    time, problem = disturber.time, disturber.problem
    report, measures = cell.palletizer.report(), measure_order(run)
    said = [visit for visit in report.visits if visit.reason and visit.time >= time]
    faults = [visit for visit in said if visit.state in FAULTS or visit.state is State.SAFE_STOP]
    placed = [box for box in measures.boxes if box.outcome == "placed" and box.name in cell_boxes(cell)]
    fates = [f"{box.name} {box.outcome}" for box in report.boxes]
    return DisturbanceReport(
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


DISTURBANCES = DisturbanceTable(
    tuple(Disturbance(what, when) for when, (*_, changes) in MOMENTS.items() for what in changes), run_case,
    "worst: of the boxes that the cell counts as placed and that are there, against their planned poses",
)  # fmt: skip
