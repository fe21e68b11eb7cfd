import numpy as np
import pytest

from pack_core.blocks.problem import CUBE, BlockSize
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


SIZED = GOOD.replace("goal: [650, 0, 0]}", "goal: [650, 0, 0], size: [40, 60, 45]}")


def test_a_block_has_its_size_and_is_a_cube_without_one() -> None:
    problem = parse_problem(SIZED, "test")
    assert problem.sizes == {"a": BlockSize(0.04, 0.06, 0.045), "b": CUBE}
    assert problem.tallest == CUBE.z
    assert parse_problem(problem_text(problem), "test") == problem


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("size: [40, 60, 45]", "size: [40, 60]", "blocks.0.size"),
        ("size: [40, 60, 45]", "size: [20, 60, 45]", "blocks.0.size.0"),
        ("size: [40, 60, 45]", "size: [40, 60, 90]", "blocks.0.size.2"),
        ("size: [40, 60, 45]", "size: [80, 90, 45]", "one of both up to 77.0 mm"),
        ("workspace:", "symmetry: 4\nworkspace:", "a is longer than wide; allowed: 1 or 2"),
        ("goal: [650, 0, 0]", "goal: [665, 0, 0]", "goals of a and b overlap"),
    ],
)
def test_a_size_that_cannot_be_is_named(old: str, new: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        parse_problem(SIZED.replace(old, new), "test")


def test_a_narrow_block_fits_where_a_cube_would_not() -> None:
    nearer = SIZED.replace("goal: [650, 0, 0]", "goal: [656, 0, 0]")
    assert parse_problem(nearer, "test").goals["a"].x == 0.656
    with pytest.raises(ConfigError, match="overlap"):
        parse_problem(nearer.replace(", size: [40, 60, 45]", ""), "test")
