import numpy as np
import pytest

from pack_core.blocks.problem_file import load_problem, parse_problem, problem_text
from pack_core.errors import ConfigError
from pack_core.paths import config_path

GOOD = """
workspace: [[500, -150], [800, -150], [800, 150], [500, 150]]
blocks:
  - {id: a, start: [600, 0, 45], goal: [650, 0, 0]}
  - {id: b, start: [700, 100, -90], goal: [702.8, 0, 0]}
"""


def test_poses_are_read_in_metres_and_radians() -> None:
    problem = parse_problem(GOOD, "test")
    assert problem.starts["a"].row == pytest.approx((0.6, 0.0, np.pi / 4))
    assert problem.goals["b"].row == pytest.approx((0.7028, 0.0, 0.0))
    assert problem.workspace[0] == pytest.approx((0.5, -0.15))


def test_what_was_written_is_read_back() -> None:
    problem = parse_problem(GOOD, "test")
    assert parse_problem(problem_text(problem), "test") == problem


def test_the_example_can_be_read() -> None:
    problem = load_problem(config_path("scenarios", "blocks", "example.yaml"))
    assert len(problem.blocks) == len(problem.goals) == 4


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("id: b", "id: a", "blocks share an id: a"),
        ("start: [600, 0, 45]", "start: [600, 0]", "blocks.0.start"),
        ("start: [600, 0, 45]", "start: [.nan, 0, 45]", "blocks.0.start"),
        ("workspace:", "worksapce:", "worksapce"),
    ],
)
def test_a_mistake_is_named(old: str, new: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        parse_problem(GOOD.replace(old, new), "test")


def test_a_missing_file_is_named() -> None:
    with pytest.raises(ConfigError, match=r"nowhere\.yaml: no such file"):
        load_problem(config_path("nowhere.yaml"))
