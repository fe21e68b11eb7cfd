"""Recordings of the blocks cell."""

import json
from pathlib import Path

import pytest

from pack_core.blocks.problem_file import load_problem, parse_problem
from pack_core.errors import BagError
from pack_core.paths import config_path
from pack_evaluation.blocks.from_bag import FIELDS, PROBLEM_FILE, problem_of, read_result

EXAMPLE = config_path("scenarios", "blocks", "example.yaml")


def test_a_result_of_another_version_is_refused_by_name() -> None:
    result = dict.fromkeys(FIELDS, 0)
    assert read_result(json.dumps(result), Path("bag")) == result
    del result["refusals"]
    with pytest.raises(BagError, match="bag: the result lacks refusals"):
        read_result(json.dumps(result), Path("bag"))


def test_the_problem_comes_with_the_result_whatever_lies_beside_the_bag(tmp_path: Path) -> None:
    text = EXAMPLE.read_text()
    (tmp_path / PROBLEM_FILE).write_text("of another goal")
    assert problem_of({"problem": text}, tmp_path) == parse_problem(text, "example")


def test_the_problem_of_an_older_recording_lies_in_a_file_beside_it(tmp_path: Path) -> None:
    (tmp_path / PROBLEM_FILE).write_text(EXAMPLE.read_text())
    for path in (tmp_path, tmp_path / "bag"):
        assert problem_of({}, path) == load_problem(EXAMPLE)
