from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_evaluation.packing.measures import measure
from pack_evaluation.packing.run import Iterations
from pack_evaluation.packing.run_file import load_saved_run, save_run
from unit.pack_evaluation.packing.runs import iterations, make_run


def test_a_saved_run_measures_as_it_did(tmp_path: Path) -> None:
    run = make_run(outcome={"exit_reason": "placed", "message": "within 15 mm", "placements": 1})
    save_run(run, tmp_path / "run.npz")
    read = load_saved_run(tmp_path / "run.npz")
    assert measure(read) == measure(run)
    assert read.outcome == run.outcome
    assert read.scene == run.scene
    assert read.iterations.stages == run.iterations.stages
    assert read.iterations.collisions == run.iterations.collisions
    for name, track in run.truth.items():
        np.testing.assert_array_equal(read.truth[name].q, track.q)
        np.testing.assert_array_equal(read.estimate[name].sources, run.estimate[name].sources)


def test_a_run_without_iterations_is_saved_too(tmp_path: Path) -> None:
    empty = iterations(())
    save_run(make_run(iterations=empty), tmp_path / "run.npz")
    read = load_saved_run(tmp_path / "run.npz").iterations
    for field in fields(Iterations):
        assert len(getattr(read, field.name)) == 0


def test_no_half_written_file_stands_under_the_runs_name(tmp_path: Path) -> None:
    save_run(make_run(), tmp_path / "run.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


@pytest.mark.parametrize("content", [b"", b"PK no archive", b"not a run at all"])
def test_what_is_no_run_is_refused_in_words(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(BagError, match=r"run\.npz is no run"):
        load_saved_run(path)


def test_a_missing_file_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(BagError, match=r"gone\.npz"):
        load_saved_run(tmp_path / "gone.npz")
