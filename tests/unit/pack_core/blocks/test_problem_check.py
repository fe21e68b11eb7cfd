"""Problems that contradict themselves or cannot be reached are refused; generated ones never are."""

import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.problem_file import parse_problem, problem_text
from pack_core.errors import ConfigError
from pack_planner.rearrangement.instances import make_instance

GOOD = """
workspace: [[490, -160], [810, -160], [810, 160], [490, 160]]
blocks:
- {id: a, start: [660, -95, 10], goal: [680, 30, 0]}
- {id: b, start: [550, 50, 0], goal: [620, 30, 0]}
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[550, 50, 0]", "[650, -90, 0]", "the starts of a and b overlap; allowed: up to 1 mm"),
        ("goal: [620, 30, 0]", "goal: [660, 30, 0]", "the goals of a and b overlap"),
        ("[620, 30, 0]", "[500, 30, 0]", "the goal of b (500.0, 30.0) mm is outside the workspace"),
        ("[810, 160], [490, 160]", "[490, 160], [810, 160]", "is no simple polygon"),
        ("[810, 160], [490, 160]", "[810, -160], [490, -160]", "key 'workspace' is no simple polygon"),
        ("[810, 160], [490", "[500, -150], [490", "is not convex"),
        ("[550, 50, 0]", "[60, 0, 0]", "mm from the robot's base; allowed: 120 to 1300 mm"),
        ("[550, 50, 0]", "[1500, 0, 0]", "is off the table; allowed: x -300 to 1200 mm"),
        ("[550, 50, 0]", "[1.0e+300, 0, 0]", "less than or equal to 10000"),
        ("[550, 50, 0]", "[.nan, 0, 0]", "finite"),
    ],
)
def test_what_cannot_be_is_named(old: str, new: str, words: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_problem(GOOD.replace(old, new), "test", blocks_cell())
    assert words in str(caught.value)


def test_starts_that_a_camera_measures_may_be_anything() -> None:
    text = GOOD.replace("[550, 50, 0]", "[660, -95, 10]")
    assert len(parse_problem(text, "test", blocks_cell(), goals_only=True).blocks) == 2


@pytest.mark.parametrize("blocks", [1, 4, 9, 16, 25])
@pytest.mark.parametrize("density", [0.1, 0.2, 0.3])
def test_generated_problems_pass(blocks: int, density: float) -> None:
    cell = blocks_cell()
    for seed in range(10, 13):
        problem = make_instance(blocks, density, seed, centre=cell.workspace.centre)
        assert len(parse_problem(problem_text(problem), "test", cell).blocks) == blocks
