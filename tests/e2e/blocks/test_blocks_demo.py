from pathlib import Path

import pytest

from e2e.command import alarms, measured_again, output_of, pack
from pack_evaluation.blocks.from_bag import load_blocks_run
from pack_evaluation.blocks.measures import measure

# three minutes: two blocks at a quarter of real time
pytestmark = [pytest.mark.e2e, pytest.mark.long, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Two blocks put side by side: the run's folder, and what was printed."""
    folder = tmp_path_factory.mktemp("demo") / "run"
    slowly = ("--real-time-factor", "0.25")
    process = pack("demo", "blocks", "--blocks", "2", "--density", "0.1", *slowly, "--output", folder)
    text = output_of(process)
    assert process.returncode == 0, text
    return folder, text


def test_the_demo_puts_the_blocks_in_place_and_leaves_everything_behind(demo: tuple[Path, str]) -> None:
    folder, text = demo
    assert {path.name for path in folder.iterdir()} == {
        "bag", "nodes.log", "plots", "problem.yaml", "replay.html", "report.html", "run.mp4", "run.yaml",
    }  # fmt: skip
    assert (folder / "plots" / "plan_1.png").is_file()
    assert "goal ended: arranged" in text
    measures = measure(load_blocks_run(folder))
    assert max(measures.error_mm.values()) < 1.5
    assert max(measures.turn_deg.values()) < 1.5
    assert (measures.disturbances, measures.unclear) == (0, 0)


def test_a_healthy_start_run_and_end_log_no_error(demo: tuple[Path, str]) -> None:
    assert alarms(demo[0]) == []


def test_evaluating_the_bag_again_gives_the_same_measures(demo: tuple[Path, str], tmp_path: Path) -> None:
    again = measured_again(demo[0], tmp_path)
    first = measure(load_blocks_run(demo[0]))
    assert again["success"]
    assert again["error_mm"] == first.error_mm
    assert again["actions"] == first.actions == 2


def test_a_problem_file_that_cannot_be_read_is_refused_at_once(tmp_path: Path) -> None:
    file = tmp_path / "problem.yaml"
    file.write_text("blocks: none\n")
    process = pack("demo", "blocks", "--problem", file, "--output", tmp_path / "run")
    text = output_of(process)
    assert process.returncode == 2
    assert "problem.yaml" in text
