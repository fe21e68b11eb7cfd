import json
import math
from pathlib import Path

import pytest

from pack_core.errors import ConfigError
from pack_lockstep.benchmarking.results_folder import TrialFile, plain, read_trials

SETTINGS = {"method": "ours", "cell": {"suction": {"pull": math.inf}}, "size": (0.24, 0.19)}


def test_trials_are_there_again_when_the_file_is_opened_again(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "trials.jsonl"
    file = TrialFile(path, "packing", SETTINGS)
    file.add({"name": "seed_1", "time": 3.5})
    file.add({"name": "seed_0", "time": math.nan})
    again = TrialFile(path, "packing", SETTINGS)
    assert list(again.trials) == ["seed_1", "seed_0"]
    assert again.trials["seed_1"] == {"name": "seed_1", "time": 3.5}
    assert read_trials(path).settings["cell"] == {"suction": {"pull": "inf"}}


def test_every_line_is_strict_json(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    TrialFile(path, "packing", SETTINGS).add({"name": "a", "value": -math.inf})

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    lines = [json.loads(line, parse_constant=refuse) for line in path.read_text().splitlines()]
    assert lines[1] == {"name": "a", "value": "-inf"}


def test_who_only_reads_leaves_a_line_alone_that_is_being_written(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    TrialFile(path, "packing", {}).add({"name": "whole"})
    with path.open("a") as file:
        file.write('{"name": "half')
    before = path.read_bytes()
    assert list(read_trials(path).trials) == ["whole"]
    assert path.read_bytes() == before


def test_a_line_that_was_cut_off_is_taken_out_and_the_trial_runs_again(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    TrialFile(path, "packing", SETTINGS).add({"name": "whole"})
    with path.open("a") as file:
        file.write('{"name": "cut", "tim')
    again = TrialFile(path, "packing", SETTINGS)
    assert list(again.trials) == ["whole"]
    again.add({"name": "cut"})
    assert list(TrialFile(path, "packing", SETTINGS).trials) == ["whole", "cut"]


def test_a_file_whose_first_line_was_cut_off_is_begun_anew(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    path.write_text('{"cell": "pack')
    TrialFile(path, "packing", SETTINGS).add({"name": "first"})
    assert list(TrialFile(path, "packing", SETTINGS).trials) == ["first"]


def test_other_settings_are_refused_and_named(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    TrialFile(path, "packing", SETTINGS)
    other = {**SETTINGS, "cell": {"suction": {"pull": 30.0}}, "extra": 1}
    with pytest.raises(ConfigError) as error:
        TrialFile(path, "packing", other)
    text = str(error.value)
    assert "cell.suction.pull: inf in the file, 30.0 now" in text
    assert "extra: nothing in the file, 1 now" in text
    assert "method" not in text
    assert "--output" in text
    assert len(TrialFile(path, "packing", SETTINGS).trials) == 0


@pytest.mark.parametrize("content", ["not json\n", "[]\n", '{"name": "no header"}\n'])
def test_what_is_no_file_of_trials_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "trials.jsonl"
    path.write_text(content)
    with pytest.raises(ConfigError, match=r"trials\.jsonl is no file of trials"):
        TrialFile(path, "packing", SETTINGS)


def test_plain_values_stay_as_they_are() -> None:
    value = {"a": [1, 2.5, None, True, "x"], "b": {"c": "d"}}
    assert plain(value) == value
