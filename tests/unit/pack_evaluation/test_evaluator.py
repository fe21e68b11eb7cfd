"""What every cell's evaluation has in common."""

import json
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import pytest

from pack_core.errors import BagError
from pack_evaluation.evaluator import Evaluation
from pack_evaluation.goals import GoalNumber
from pack_evaluation.record import load_record


class End(Enum):
    PLACED = "placed"


@dataclass(frozen=True)
class Found:
    end: End
    errors: tuple[float, float]
    by_name: dict[str, float]


@dataclass(frozen=True)
class Run:
    is_cut: bool = True
    damaged: int = 4
    goal: GoalNumber = GoalNumber(2, 3)  # noqa: RUF009


def test_measures_become_json_with_null_for_what_there_is_not() -> None:
    measures = Found(End.PLACED, (float("nan"), 1.0), {"a": float("nan"), "b": 2.0})
    found = Evaluation(Run(), measures, (), {}, [], None, Path("report.html"))
    expected = {
        "end": "placed", "errors": [None, 1.0], "by_name": {"a": None, "b": 2.0},
        "is_cut": True, "damaged": 4, "goal": 2, "goals": 3,
    }  # fmt: skip
    assert json.loads(json.dumps(found.to_json(), allow_nan=False)) == expected


def test_the_record_is_found_in_the_runs_folder_and_beside_its_bag(tmp_path: Path) -> None:
    assert load_record(tmp_path) == {}
    (tmp_path / "run.yaml").write_text("cell: blocks\n")
    assert load_record(tmp_path) == load_record(tmp_path / "bag") == {"cell": "blocks"}


@pytest.mark.parametrize("text", ["", "cell", "cell: [", "- 1"])
def test_a_broken_record_is_named(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.yaml").write_text(text)
    with pytest.raises(BagError, match=r"run\.yaml is broken"):
        load_record(tmp_path)
