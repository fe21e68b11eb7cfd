"""An order in the palletizing cell in one process, without ROS, on simulated time."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pack_core.motion.target import MotionStatus, MotionTarget
from pack_core.palletizing.calibration import CellCalibration
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.ports import Command, PursueTarget
from pack_evaluation.palletizing.run import PalletRun
from pack_lockstep.palletizing.box_finder import BoxFinder, open_box_finder
from pack_lockstep.palletizing.run_log import PalletRunLog
from pack_lockstep.palletizing.stepped_cell import PalletLockstepConfig, SteppedCell
from pack_motion.reference.trajectory import JointState
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.states import State


@dataclass(frozen=True)
class Tick:
    """One cycle of the loop, for logs: state of the machine, box in work, and status of the motion."""

    time: float
    state: State
    box: str
    motion: MotionStatus


class PalletLockstep:
    """Runs one order from start to end.

    Args:
        cell: the cell's physical facts.
        order: the order to build.
        plan: the place of every box.
        config: parameters.
        seed: seed of the poses at which boxes arrive and of the detections' noise.

    Attributes:
        stepped: the simulated cell.
        simulator: its physics.
    """

    def __init__(
        self,
        cell: PalletizingCell,
        order: Order,
        plan: LayoutPlan,
        config: PalletLockstepConfig,
        seed: int,
        calibration: CellCalibration | None = None,
    ) -> None:
        known = cell if calibration is None else calibration.applied(cell)
        assumed = None if calibration is None else calibration.gears
        self._known, self._config, self._seed = known, config, seed
        self._rng = np.random.default_rng([seed, zlib.crc32(order.order_id.encode())])
        self.stepped = SteppedCell(
            cell, known, config, seed, self._rng, lambda reason: self.palletizer.halt(reason), assumed
        )
        self.simulator = self.stepped.simulator
        self.palletizer = Palletizer(
            OrderBook.of_order(order, plan, known), known, config.palletizer, self.simulator.time
        )
        self._log = PalletRunLog(self.simulator, config.period, known)
        self._target: State | None = None

    def run(
        self,
        on_tick: Callable[[Tick], None] | None = None,
        on_target: Callable[[JointState, MotionTarget], None] | None = None,
    ) -> PalletRun:
        """Run to the end.

        Args:
            on_tick: is called in every cycle.
            on_target: sees what the arm is asked for, and the state in which it is.
        """
        if on_target is not None:
            self.stepped.on_target = lambda target: on_target(self.stepped.motion.commanded, target)
        with open_box_finder(self._known, self._config.sight, self.simulator, self._rng) as finder:
            while not self.palletizer.machine.is_over:
                self._turn(finder, on_tick)
        for _ in range(round(self._config.settle / self._config.period)):
            self._advance()
        return self._log.run(self._seed, self.palletizer.report())

    def _turn(self, finder: BoxFinder, on_tick: Callable[[Tick], None] | None) -> None:
        """One cycle: observe, step the machine, carry out its commands, and advance motion and physics."""
        machine = self.palletizer.machine
        seen = self.stepped.observe()
        before = self._target
        for command in self.palletizer.step(seen):
            self._apply(command)
        self.stepped.expose(finder)
        if self.palletizer.leg_end is None and before is not None:
            self._log.note_way_point(before, seen.motion)
        self._target = self.palletizer.leg_end
        if on_tick is not None:
            on_tick(Tick(seen.time, machine.state, machine.visits[-1].box, seen.motion))
        self._advance()

    def _apply(self, command: Command) -> None:
        is_accepted = self.stepped.apply(command)
        if isinstance(command, PursueTarget) and is_accepted:
            self._log.note_target(self.stepped.motion.plan.X_WT)

    def _advance(self) -> None:
        self._log.note(self.stepped.arm.q_des, self.stepped.motion)
        self.stepped.advance()
