"""Goals of the palletizing cell, an order, a shift or a calibration, and their nodes' parameters."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.graph.graph import conditions, flat_parameters
from pack_bringup.job import Progress, recorder_parameters
from pack_core.config import merged
from pack_core.palletizing.calibration import known_cell
from pack_core.palletizing.shift_journal import JOURNAL, SETTLED, read_interrupted
from pack_core.paths import config_path

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract

SMALL_ORDERS = (9, 3, 14, 15, 1, 16, 6, 17)
"""Numbers of the orders of config/orders with two to five boxes. The first one begins with a box that is
stood up on table B and so passes every state; the others are sorted by their size."""


@dataclass(frozen=True)
class PalletizingGoal:
    """What to build, and how.

    Attributes:
        order: an order's file.
        seed: of where boxes arrive.
        profile: blended or thesis; empty: that of config/nodes/palletizing/fsm.yaml.
    """

    order: Path
    seed: int = 0
    profile: str = ""
    cell: str = "palletizing"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Palletize

        from pack_core.ros.contracts.palletizing import PALLETIZE
        from pack_core.text.reader import read_text

        return PALLETIZE, Palletize.Goal(order=read_text(self.order), profile=self.profile)

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the cell, and its request."""
        return reset_of(self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.box} {feedback.state}",
            f"{feedback.state:18} {feedback.box:14} {feedback.placed:2}/{feedback.boxes}  "
            f"{feedback.elapsed:6.1f} s  real-time factor {real_time_factor:4.2f}",
        )


def reset_of(seed: int) -> tuple[Contract, Any]:
    """The service that empties the cell and brings the arm home, and its request."""
    from pack_interfaces.srv import ResetCell

    from pack_core.ros.contracts.palletizing import RESET

    return RESET, ResetCell.Request(seed=seed)


def seeded_goal(seed: int) -> PalletizingGoal:
    """The goal of a run without choices: one of the small orders of config/orders."""
    orders = [config_path("orders", f"order_{number:02}.json") for number in SMALL_ORDERS]
    return PalletizingGoal(order=orders[seed % len(orders)], seed=seed)


@dataclass(frozen=True)
class GivenOrderGoal(PalletizingGoal):
    """An order that comes as text.

    Attributes:
        text: the order as JSON.
    """

    order: Path = Path()
    text: str = ""

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Palletize

        from pack_core.ros.contracts.palletizing import PALLETIZE

        return PALLETIZE, Palletize.Goal(order=self.text, profile=self.profile)


def given_goal(text: str, seed: int) -> PalletizingGoal:
    """The goal of an order's text.

    Raises:
        OrderError: the cell cannot build it.
    """
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import parse_order

    parse_order(text, "the order", cell=palletizing_cell())
    return GivenOrderGoal(seed=seed, text=text)


@dataclass(frozen=True)
class CellCalibrationGoal:
    """What to do.

    Attributes:
        check: only test the calibration that the cell was started with.
        seed: of the noise; which cell it is was said when it was started.
    """

    check: bool = False
    seed: int = 0
    cell: str = "palletizing"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import CalibrateCell

        from pack_core.ros.contracts.palletizing import CALIBRATE

        return CALIBRATE, CalibrateCell.Goal(check=self.check)

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the cell, and its request."""
        return reset_of(self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        from pallet_calibration.progress import CalibrationProgress, CalibrationState

        now = CalibrationProgress(
            CalibrationState(feedback.state), feedback.what, feedback.number, feedback.count,
            feedback.remaining,
        )  # fmt: skip
        return Progress(
            f"{feedback.state} {feedback.number}",
            f"{now.words}  {feedback.elapsed:6.1f} s  real-time factor {real_time_factor:4.2f}",
        )


@dataclass(frozen=True)
class ShiftGoal:
    """A shift to run, or to go on with.

    Attributes:
        folder: of the journal.
        boxes: it ends when so many have come.
        seed: of what comes on a simulated conveyor.
        is_resumed: whether it goes on with what the journal has; boxes and seed are those of it.
    """

    folder: Path
    boxes: int = 0
    seed: int = 0
    is_resumed: bool = False
    cell: str = "palletizing"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import RunShift

        from pack_core.ros.contracts.palletizing import RUN_SHIFT

        return RUN_SHIFT, RunShift.Goal(
            folder=str(self.folder.resolve()), boxes=self.boxes, seed=self.seed, resume=self.is_resumed
        )

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the cell, and its request: with what stands, of a shift that goes on."""
        if not self.is_resumed:
            return reset_of(self.seed)
        from pack_interfaces.srv import ResetCell

        from pack_core.palletizing.boxes import BoxBody
        from pack_core.ros.contracts.palletizing import RESET
        from pack_core.ros.messages.palletizing import to_simulated
        from pallet_fsm.taking_over import standing_by_journal

        written = read_interrupted(self.folder / JOURNAL)
        standing = [
            to_simulated(BoxBody(work.name, work.box.dims, work.box.weight), work.X_WB)
            for work, _ in standing_by_journal(written.events)
            if work.X_WB is not None
        ]
        come = sorted({event.box for event in written.events if event.kind in SETTLED})
        return RESET, ResetCell.Request(seed=written.facts["seed"], standing=standing, come=come)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.box} {feedback.state}",
            f"{feedback.state:18} {feedback.box:24.24} {feedback.came} of {feedback.boxes} came, "
            f"{feedback.placed} on pallets  {feedback.elapsed:6.1f} s  "
            f"real-time factor {real_time_factor:4.2f}",
        )


@dataclass(frozen=True)
class PalletizingJob(PalletizingGoal):
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/ and run.yaml go there.
        real_time_factor: None: that of config/nodes/palletizing/sim.yaml.
        command: the command line, for run.yaml.
        visitors: who comes near the arm: a file of config/visitors, `random`, or nobody.
        preset: of config/presets/palletizing; empty: the configuration files as they are.
        calibration: its calibration file; None: none.
    """

    folder: Path = field(kw_only=True)
    real_time_factor: float | None = None
    command: str = ""
    visitors: str = ""
    preset: str = ""
    calibration: Path | None = None

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed), **({"visitors": self.visitors} if self.visitors else {})}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        recorder = recorder_parameters(self, self.seed, self.command)
        given = conditions(self.cell, self.preset, self.calibration)
        return merged(given, {"sim": sim, "recorder": recorder})


def seeded_job(
    seed: int, folder: Path, *, real_time_factor: float | None, preset: str, command: str
) -> PalletizingJob:
    """The job of a seed, as `pack_bringup.job.SeededJob` has it."""
    return PalletizingJob(
        seeded_goal(seed).order, seed, folder=folder, real_time_factor=real_time_factor, preset=preset,
        command=command,
    )  # fmt: skip


@dataclass(frozen=True)
class LiveShiftJob(ShiftGoal):
    """A shift, and the nodes that are started for it.

    Attributes:
        real_time_factor: None: that of config/nodes/palletizing/sim.yaml.
        command: the command line, for run.yaml.
    """

    real_time_factor: float | None = None
    command: str = ""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed)}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        recorder = recorder_parameters(self, self.seed, self.command)
        return merged(conditions(self.cell, "shift", None), {"sim": sim, "recorder": recorder})


NODES = ("sim", "vision", "fsm")
"""The nodes that know the cell: its driver, its eye, and the machine that places boxes."""
LAYOUT, RECORDER = "layout", "recorder"
"""What knows where a shift's pallets are, and what notes the preset's name in run.yaml."""


def preset_overrides(name: str) -> dict[str, dict[str, str]]:
    """What a preset changes, by node and parameter, as YAML text.

    Nodes that know the cell are told the preset's name and read the cell's facts themselves.

    Raises:
        ConfigError: there is no such preset, or it changes what is not there.
    """
    from pack_lockstep.palletizing.settings import CORES, checked_preset, set_up

    set_up(preset=name)
    preset = checked_preset(name)
    named = {node: {"preset": json.dumps(name)} for node in (*NODES, LAYOUT, RECORDER)}
    return merged({node: flat_parameters(getattr(preset, node)) for node in CORES}, named)


def calibration_overrides(preset: str, file: Path) -> dict[str, dict[str, str]]:
    """What a calibration changes, by node and parameter, as YAML text.

    Args:
        preset: what the cell is like; empty: the ideal one.
        file: what `pack calibrate palletizing` has written.

    Raises:
        ConfigError: the file cannot be read, or was made under another preset.
    """
    known_cell(preset or "rigid", str(file))
    return {node: {"calibration": json.dumps(str(file.resolve()))} for node in NODES}
