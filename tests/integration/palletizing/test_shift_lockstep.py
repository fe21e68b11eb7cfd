"""A shift in physics: a box comes on the conveyor, is measured, and is put on a pallet."""

from dataclasses import replace
from pathlib import Path

import pytest

from pack_core.palletizing.shift_journal import EventKind, ShiftJournal, read_journal
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
    assert (run.touches, run.fallen) == ((), ())
    (put_down,) = [event for event in run.events if event.kind is EventKind.PUT_DOWN]
    assert read_journal(tmp_path / "journal.db").events == run.events
    standing = {pallet.place: [box.name for box in pallet.boxes] for pallet in run.left}
    assert standing[put_down.place] == [put_down.box]
