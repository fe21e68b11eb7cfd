"""Results of any kind side by side, each under a name of its own."""

from pathlib import Path
from typing import Any

from pack_core.paths import bags_path
from pack_evaluation.study import Study, summaries
from pack_lockstep.benchmarking.results_folder import ResultsFolder
from pack_lockstep.benchmarking.side_by_side import gather, with_names_that_differ

BOX = {
    "name": "a", "handling": "none", "outcome": "placed", "is_ok": True, "error_mm": 1.0, "angle_deg": 0.1,
    "cycle_s": 8.0, "coaxial_N": 1.0, "shear_N": 1.0, "moment_Nm": 1.0,
}  # fmt: skip
ORDER = {
    "is_complete": True, "boxes": [BOX], "position_mm": (0.1, 0.5), "orientation_deg": (0.01, 0.05),
    "goal_mm": (0.1, 0.2), "shift_mm": [0.1], "drops": 0, "touches": 0, "interruptions": 1,
    "faults": [], "duration_s": 10.0,
}  # fmt: skip


def orders(folder: Path, name: str = "thesis shipped rigid noise", **changes: Any) -> Path:
    """A folder with one order of the palletizing cell."""
    file = ResultsFolder(folder).open("palletizing", {"name": name}, {"commit": "1a2b"})
    file.add({"name": "o1_seed0", "order": "o1", "seed": 0, "measures": ORDER, "hold_mm": 2.0} | changes)
    return folder


def test_benchmarks_and_recordings_of_several_cells_are_sorted_by_cell(tmp_path: Path) -> None:
    sample = bags_path() / "samples" / "packing"
    read: list[Path] = []
    paths = [orders(tmp_path / "orders"), sample, tmp_path / "nothing"]
    found = gather(paths, read.append)
    assert read == paths
    assert [(item.cell, [study.name for study in item.studies]) for item in found.cells] == [
        ("packing", ["recordings"]),
        ("palletizing", ["thesis shipped rigid noise"]),
    ]
    assert list(found.left_out) == [tmp_path / "nothing"]
    pallets = found.cells[1]
    assert summaries(pallets.evaluator, pallets.studies)["thesis shipped rigid noise"]["boxes_ok"] == 1
    for item in found.cells:
        for table in item.evaluator.tables(item.studies):
            assert {len(row) for row in table.rows} <= {len(table.head)}


def test_studies_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    (item,) = gather([orders(tmp_path / "one"), orders(tmp_path / "two")]).cells
    assert [study.name for study in item.studies] == [
        f"thesis shipped rigid noise ({tmp_path / folder})" for folder in ("one", "two")
    ]


def test_a_detail_that_differs_says_more_than_a_folder() -> None:
    origin = {"results": "bags/x"}
    studies = [Study(name="beam", detail=kind, origin=origin) for kind in ("4 blocks", "9 blocks")]
    named = with_names_that_differ([*studies, Study(name="pirs", detail="4 blocks")])
    assert [study.name for study in named] == ["beam (4 blocks)", "beam (9 blocks)", "pirs"]


def test_trials_that_another_version_kept_are_left_out_with_what_they_lack(tmp_path: Path) -> None:
    folder = tmp_path / "old"
    file = ResultsFolder(folder).open("palletizing", {"name": "x"}, {"commit": "1a2b"})
    file.add({"name": "o1_seed0", "order": "o1", "seed": 0, "measures": ORDER})
    found = gather([folder])
    assert found.cells == ()
    assert "o1_seed0 lacks hold_mm; another version kept it (commit 1a2b)" in found.left_out[folder]


def test_a_recording_of_a_cell_that_there_is_not_is_left_out_by_name(tmp_path: Path) -> None:
    (tmp_path / "run.yaml").write_text("cell: juggling\n")
    assert "cell 'juggling'; known: packing" in gather([tmp_path]).left_out[tmp_path]
