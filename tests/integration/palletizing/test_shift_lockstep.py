"""A shift in physics: a box comes on the conveyor, is measured, and is put on a pallet."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.shift_journal import EventKind, ShiftJournal, read_journal
from pack_core.rotations import Pose
from pack_lockstep.palletizing.shift_lockstep import ShiftLockstep, ShiftRunSetup, shift_run_setup
from pack_sim.palletizing.arrivals import ArrivalConfig


def setup_with_a_short_conveyor() -> ShiftRunSetup:
    """The cell for shifts; boxes have less far to come."""
    setup = shift_run_setup(arrivals=ArrivalConfig(faulty=0.0))
    cell = setup.stream.cell
    infeed = cell.shift.infeed.model_copy(update={"length": 0.9})
    places = cell.shift.model_copy(update={"infeed": infeed})
    return replace(setup, stream=replace(setup.stream, cell=cell.model_copy(update={"shift": places})))


@pytest.mark.timeout(300)
def test_a_box_is_brought_measured_and_put_on_a_pallet(tmp_path: Path) -> None:
    with ShiftJournal(tmp_path / "journal.db", {}) as journal:
        run = ShiftLockstep(setup_with_a_short_conveyor(), boxes=1, seed=1003).run(journal.write)
    assert run.reason == "all boxes came"
    assert not {EventKind.TOUCHED, EventKind.FELL} & {event.kind for event in run.events}
    (put_down,) = [event for event in run.events if event.kind is EventKind.PUT_DOWN]
    assert read_journal(tmp_path / "journal.db").events == run.events
    standing = {pallet.place: [box.name for box in pallet.boxes] for pallet in run.left}
    assert standing[put_down.place] == [put_down.box]


@pytest.mark.timeout(300)
def test_a_box_that_falls_on_the_arm_is_in_the_journal(tmp_path: Path) -> None:
    with ShiftJournal(tmp_path / "journal.db", {}) as journal:
        shift = ShiftLockstep(setup_with_a_short_conveyor(), boxes=1, seed=1003)
        simulator = shift.stepped.simulator
        over_arm = Pose(simulator.tool_pose().p + np.array([0.0, 0.0, 2.0]), np.array([1.0, 0.0, 0.0, 0.0]))
        simulator.spawn(BoxBody("stray", (0.2, 0.2, 0.2), 5.0), over_arm)
        shift.run(journal.write)
    written = read_journal(tmp_path / "journal.db").events
    touched = [event for event in written if event.kind is EventKind.TOUCHED]
    assert all("stray" in event.reason and event.data["force"] > 0.0 for event in touched)
    assert touched
    assert [event.box for event in written if event.kind is EventKind.FELL] == ["stray"]
