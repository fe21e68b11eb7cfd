"""Two records of the same runs are compared to the last digit, but for what the wall clock decides."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from regression.__main__ import app
from regression.comparison import RunMissingError, array_differences, differences, run_differences


def write_run(folder: Path, force: float, wall_time: float, joints: list[float]) -> None:
    (folder / "runs").mkdir(parents=True)
    (folder / "summary.json").write_text(json.dumps({"success": 1, "iteration_ms": wall_time}))
    trial = {"name": "seed_50", "seed": 50, "force": force, "wall_time_s": wall_time}
    (folder / "trials.jsonl").write_text(
        json.dumps({"settings": wall_time}) + "\n" + json.dumps(trial) + "\n"
    )
    np.savez(
        folder / "runs" / "seed_50.npz", joints=np.array(joints), **{"iterations/ms": np.array(wall_time)}
    )


def test_equal_runs_that_took_different_times_do_not_differ(tmp_path: Path) -> None:
    write_run(tmp_path / "old", 10.0, 1.0, [0.1, np.nan])
    write_run(tmp_path / "new", 10.0, 2.0, [0.1, np.nan])
    assert list(run_differences(tmp_path / "old", tmp_path / "new")) == []


def test_a_last_digit_of_a_trial_and_of_an_array_is_noticed(tmp_path: Path) -> None:
    write_run(tmp_path / "old", 10.0, 1.0, [0.1])
    write_run(tmp_path / "new", np.nextafter(10.0, 11.0), 1.0, [np.nextafter(0.1, 1.0)])
    found = list(run_differences(tmp_path / "old", tmp_path / "new"))
    assert found == [
        "trials/seed_50 50/force: 10.0 -> 10.000000000000002",
        "seed_50.npz: joints: not the same",
    ]


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ({"a": 1}, {"a": 1, "b": 2}, ["/b: (absent) -> 2"]),
        ({"a": 1}, {}, ["/a: 1 -> (absent)"]),
        ([1, 2], [1], [": [1, 2] -> [1]"]),
        ({"a": [{"b": 1}]}, {"a": [{"b": 2}]}, ["/a[0]/b: 1 -> 2"]),
    ],
)
def test_a_difference_is_named_by_its_place(old: object, new: object, found: list[str]) -> None:
    assert list(differences(old, new)) == found


def test_an_array_that_one_run_lacks_is_a_difference(tmp_path: Path) -> None:
    np.savez(tmp_path / "old.npz", joints=np.zeros(2), force=np.zeros(3))
    np.savez(tmp_path / "new.npz", joints=np.zeros(2))
    assert list(array_differences(tmp_path / "old.npz", tmp_path / "new.npz")) == [
        "force: only in one of both"
    ]


def test_a_run_without_results_is_an_error_and_not_the_same(tmp_path: Path) -> None:
    write_run(tmp_path / "old", 10.0, 1.0, [0.1])
    with pytest.raises(RunMissingError, match=r"new has no summary\.json"):
        list(run_differences(tmp_path / "old", tmp_path / "new"))


def test_the_command_names_a_run_that_one_record_lacks_and_compares_the_others(tmp_path: Path) -> None:
    for folder, name in (
        ("old", "packing"),
        ("new", "packing"),
        ("old", "packing_fill"),
        ("new", "blocks_pirs"),
    ):
        write_run(tmp_path / folder / name, 10.0, 1.0, [0.1])
    done = CliRunner().invoke(app, ["compare", str(tmp_path / "old"), str(tmp_path / "new")])
    assert done.exit_code == 1
    first, second, third = done.output.splitlines()
    assert first == "packing: the same"
    assert second.startswith(f"packing_fill: not compared: {tmp_path}/new/packing_fill has no summary.json")
    assert third.startswith(f"blocks_pirs: not compared: {tmp_path}/old/blocks_pirs has no summary.json")


def test_two_folders_without_runs_are_refused(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["compare", str(tmp_path / "old"), str(tmp_path / "new")])
    assert done.exit_code == 2
    assert "neither" in done.output


def test_an_array_file_that_one_run_lacks_is_a_difference(tmp_path: Path) -> None:
    for folder in ("old", "new"):
        write_run(tmp_path / folder, 10.0, 1.0, [0.1])
    (tmp_path / "new" / "runs" / "seed_50.npz").unlink()
    (found,) = run_differences(tmp_path / "old", tmp_path / "new")
    assert found == f"seed_50.npz: (absent) in {tmp_path}/new"
