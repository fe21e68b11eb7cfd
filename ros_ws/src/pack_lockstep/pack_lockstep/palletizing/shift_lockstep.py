"""A shift in the palletizing cell in one process, without ROS, on simulated time: everything moves."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import REORIENTATION_TABLE
from pack_core.palletizing.orders.box_stream import shipped_lists
from pack_core.palletizing.orders.next_place import PlaceAnswer
from pack_core.palletizing.ports import AskPlace, Command, TakePallet
from pack_core.palletizing.shift_journal import SETTLED, EventKind, ShiftEvent
from pack_core.rotations import Pose
from pack_lockstep.palletizing.box_finder import BoxFinder, open_box_finder
from pack_lockstep.palletizing.settings import (
    ArrivalParameters,
    ShiftParameters,
    checked_preset,
    place_parameters,
    preset_parameters,
    set_up,
)
from pack_lockstep.palletizing.shift import BoxStreamConfig, ShiftSetup, shift_setup, stream_of
from pack_lockstep.palletizing.stepped_cell import PalletLockstepConfig, SteppedCell
from pack_planner.layout.online_planner import OnlineConfig
from pack_planner.layout.place_answers import PlaceAnswers
from pack_sim.palletizing.arrivals import ArrivalConfig, Arrivals, BoxFault
from pallet_fsm.goals import warm_up
from pallet_fsm.palletizer_config import ScanConfig
from pallet_fsm.shift_job import ShiftConfig, ShiftJob
from pallet_fsm.taking_over import TakenOver, standing_by_journal, take_over

PRESET = "shift"
"""The conditions under which the cell has a conveyor and two pallets."""
DETECTIONS = 12
"""Stream of random numbers of the noise of detections."""
DECISION = 0.1
"""Time from a question to its answer [s]."""
FALLEN = 0.1
"""A box whose middle is lower over the floor lies on it, as no deck is so low [m]."""


@dataclass(frozen=True)
class ClosedPallet:
    """A pallet that was taken away: its place, when [s], its boxes and where they truly stood."""

    place: str
    time: float
    boxes: dict[BoxBody, Pose]


@dataclass(frozen=True)
class ShiftRun:
    """What is known of a shift that has ended.

    Attributes:
        seed: seed of what came, and of all noise.
        reason: why it ended.
        time: how long it took [s].
        events: what happened, in order.
        pallets: those that were taken away.
        left: what stood in the cell at the end, by the name of the place: pallets that were not full.
        faults: by what boxes were tracked by, what was wrong with those of which something was.
        decisions: processor time of each decision [s].
    """

    seed: int
    reason: str
    time: float
    events: tuple[ShiftEvent, ...]
    pallets: tuple[ClosedPallet, ...]
    left: tuple[ClosedPallet, ...]
    faults: dict[str, BoxFault]
    decisions: tuple[float, ...]


@dataclass(frozen=True)
class ShiftRunSetup:
    """All settings that decide the results, besides the seeds.

    Attributes:
        stream: what comes, and the planner's settings.
        config: parameters of the cell.
        shift: parameters of the shift.
        arrivals: how boxes come.
    """

    stream: ShiftSetup
    config: PalletLockstepConfig
    shift: ShiftConfig
    arrivals: ArrivalConfig


def shift_run_setup(
    online: OnlineConfig | None = None, stream: BoxStreamConfig | None = None,
    arrivals: ArrivalConfig | None = None,
) -> ShiftRunSetup:  # fmt: skip
    """The settings of the cell for shifts, boxes being found by their true pose with noise.

    Args:
        online: where boxes go; None: as the nodes' configuration has it.
        stream: what comes; None: any boxes of the lists.
        arrivals: how they come; None: as the nodes' configuration has it.
    """
    cell, preset = set_up(preset=PRESET, vision=False), checked_preset(PRESET)
    online = online or place_parameters(PRESET)
    arrivals = arrivals or preset_parameters(preset, "sim", ArrivalParameters).arrivals
    shift = preset_parameters(preset, "fsm", ShiftParameters).shift
    stream = stream or BoxStreamConfig()
    drawn = shift_setup(shipped_lists(), cell.cell, online, stream, cell.layout.insertion)
    return ShiftRunSetup(drawn, cell.config, shift, arrivals)


class ShiftLockstep:
    """Runs one shift.

    Args:
        setup: the settings.
        boxes: the shift ends when so many have come and are in their places.
        seed: seed of what comes, and of all noise.
        before: what the journal has of a shift that was interrupted and is gone on with; what it says of
            boxes that stand is how the simulated cell begins. A box that was under way comes again.
    """

    def __init__(
        self, setup: ShiftRunSetup, boxes: int, seed: int, before: Sequence[ShiftEvent] = ()
    ) -> None:
        warm_up()
        settled = frozenset(event.box for event in before if event.kind in SETTLED)
        stream, config = setup.stream, setup.config
        self._config, self._cell, self._seed = config, stream.cell, seed
        self._arrivals = Arrivals(stream.items, stream_of(stream, seed), setup.arrivals, seed, settled)
        self._rng = np.random.default_rng([seed, DETECTIONS])
        catalogue = {item.id: item for item in stream.items}
        self.stepped = SteppedCell(
            stream.cell, stream.cell, config, seed, self._rng, lambda reason: self.job.halt(reason),
            arrivals=self._arrivals, time=before[-1].time if before else 0.0,
        )  # fmt: skip
        self.job = ShiftJob(
            stream.cell,
            catalogue,
            setup.shift,
            config.palletizer,
            boxes - len(settled),
            self._taken_over(before, config.palletizer.scans),
        )
        self._planner = PlaceAnswers(stream.cell, stream.config, stream.insertion)
        self._answer: tuple[float, PlaceAnswer] | None = None
        self._decisions: list[float] = []
        self._pallets: list[ClosedPallet] = []
        self._fallen: set[str] = set()

    def _taken_over(self, before: Sequence[ShiftEvent], config: ScanConfig) -> TakenOver:
        """What the journal says is put into the simulated cell, but for rejects; what is seen of it then."""
        standing = standing_by_journal(before)
        if not standing:
            return TakenOver()
        for work, _ in standing:
            self.stepped.simulator.spawn(BoxBody(work.name, work.box.dims, work.box.weight), work.X_WB)
        scans = {place: self.stepped.scan(place) for place in (*self._cell.pallets, REORIENTATION_TABLE)}
        return take_over(standing, scans, self._cell, config)

    def run(self, on_events: Callable[[tuple[ShiftEvent, ...]], None] = lambda events: None) -> ShiftRun:
        """Run to the end.

        Args:
            on_events: is called with what has happened, at once.
        """
        events: list[ShiftEvent] = []
        simulator = self.stepped.simulator
        with open_box_finder(self._cell, self._config.sight, simulator, self._rng) as finder:
            while not self.job.is_over:
                self._turn(finder)
                happened = (*self.job.events(), *self._touches(simulator.time))
                if happened:
                    happened = (*happened, *self._falls())
                    events += happened
                    on_events(happened)
        for _ in range(round(self._config.settle / self._config.period)):
            self.stepped.advance()
        happened = (*self._touches(math.inf), *self._falls())
        events += happened
        on_events(happened)
        left = tuple(self._closed(place, simulator.over(place)) for place in self._cell.pallets)
        return ShiftRun(
            self._seed, self.job.reason, simulator.time, tuple(events), tuple(self._pallets), left,
            self._arrivals.faults, tuple(self._decisions),
        )  # fmt: skip

    def _touches(self, until: float) -> tuple[ShiftEvent, ...]:
        """Unwanted contacts that ended before `until` [s], each once."""
        simulator = self.stepped.simulator
        return tuple(
            ShiftEvent(
                simulator.time, EventKind.TOUCHED,
                reason=f"{' and '.join(touch.bodies)} for {touch.duration:.2f} s, up to {touch.force:.0f} N",
                data={"began": touch.time, "duration": touch.duration, "force": touch.force},
            )
            for touch in simulator.contacts.finished(until)
        )  # fmt: skip

    def _falls(self) -> tuple[ShiftEvent, ...]:
        """Boxes that lie on the floor, each once."""
        simulator = self.stepped.simulator
        low = {name for name, state in simulator.truth().objects.items() if state.X_WO.p[2] < FALLEN}
        found = sorted(low - self._fallen)
        self._fallen |= low
        return tuple(
            ShiftEvent(simulator.time, EventKind.FELL, box, reason="lies on the floor") for box in found
        )

    def _turn(self, finder: BoxFinder) -> None:
        """One cycle: observe, step the shift, carry out its commands, and advance motion and physics."""
        seen = self.stepped.observe()
        if self._answer is not None and seen.time >= self._answer[0]:
            seen = replace(seen, place=self._answer[1])
        for command in self.job.step(seen):
            self._apply(command)
        self.stepped.expose(finder)
        self.stepped.advance()

    def _apply(self, command: Command) -> None:
        match command:
            case AskPlace(question):
                started = time.thread_time()
                answer = self._planner.answer(question)
                self._decisions.append(time.thread_time() - started)
                self._answer = self.stepped.simulator.time + DECISION, answer
            case TakePallet(place, boxes):
                self._pallets.append(self._closed(place, boxes))
                self.stepped.apply(command)
            case _:
                self.stepped.apply(command)

    def _closed(self, place: str, names: tuple[str, ...]) -> ClosedPallet:
        simulator = self.stepped.simulator
        truth = simulator.truth().objects
        boxes = {box: truth[box.name].X_WO for box in simulator.boxes if box.name in names}
        return ClosedPallet(place, simulator.time, boxes)
